/**
 * A measured wind: the fluctuations of a recording, carried downwind unchanged (Taylor 1938).
 */
import { RECORDED_LATERAL_SHARE } from "../../constants";
import type { ResolvedWind } from "../document";
import { type Gusts, type Output, type Places, View } from "../frame";
import { fluctuations, type Recording } from "../recording";

export class RecordedGusts implements Gusts {
  private readonly samples: Float64Array;
  private readonly interval_s: number;
  private readonly view = new View(RECORDED_LATERAL_SHARE);

  constructor(recording: Recording) {
    this.samples = fluctuations(recording);
    this.interval_s = recording.interval_s;
  }

  /** Cubic interpolation (Catmull–Rom): it passes through the samples, and the load has no kinks. */
  velocity(wind: ResolvedWind, time_s: number, x: Places, z: Places, outX: Output, outZ: Output): void {
    const { samples, interval_s, view } = this;
    const count = samples.length / 2;
    view.set(wind, 0);
    for (let i = 0; i < outX.length; i++) {
      const age = time_s - (view.cos * x[i] + view.sin * z[i]) / wind.convection_speed_m_s;
      const position = age / interval_s;
      const first = Math.floor(position);
      const t = position - first;
      let a = 0;
      let b = 0;
      for (let k = 0; k < 4; k++) {
        const weight =
          k === 0
            ? t * (t * (2 - t) - 1)
            : k === 1
              ? t * t * (3 * t - 5) + 2
              : k === 2
                ? t * (t * (4 - 3 * t) + 1)
                : t * t * (t - 1);
        const at = 2 * ((((first + k - 1) % count) + count) % count);
        a += weight * samples[at];
        b += weight * samples[at + 1];
      }
      view.write(i, a / 2, b / 2, outX, outZ);
    }
  }
}
