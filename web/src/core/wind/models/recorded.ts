/**
 * A measured wind: the fluctuations of a recording, carried downwind unchanged (Taylor 1938). Same arithmetic as
 * precompute/galewood/wind/.
 */
import type { ResolvedWind } from "../document";
import { type Gusts, type Output, type Places, View } from "../frame";
import { fluctuations, type Recording } from "../recording";

const LATERAL_SHARE = 1;

export class RecordedGusts implements Gusts {
  private readonly samples: Float64Array;
  private readonly interval_s: number;
  private readonly view = new View(LATERAL_SHARE);

  constructor(recording: Recording) {
    this.samples = fluctuations(recording);
    this.interval_s = recording.interval_s;
  }

  /** Cubic interpolation (Catmull–Rom): it passes through the samples, and the load has no kinks. */
  velocity(wind: ResolvedWind, time_s: number, x: Places, z: Places, outX: Output, outZ: Output): void {
    const { samples, interval_s, view } = this;
    const convection = wind.convection_speed_m_s;
    const count = samples.length / 2;
    view.set(wind, 0);
    for (let i = 0; i < outX.length; i++) {
      const age = time_s - (view.cos * x[i] + view.sin * z[i]) / convection;
      const position = age / interval_s;
      const first = Math.floor(position);
      const t = position - first;
      const k1 = first - count * Math.floor(first / count);
      const k0 = 2 * (k1 === 0 ? count - 1 : k1 - 1);
      const k2 = 2 * ((k1 + 1) % count);
      const k3 = 2 * ((k1 + 2) % count);
      const w0 = 0.5 * t * (t * (2 - t) - 1);
      const w1 = 0.5 * (t * t * (3 * t - 5) + 2);
      const w2 = 0.5 * t * (t * (4 - 3 * t) + 1);
      const w3 = 0.5 * t * t * (t - 1);
      const at = 2 * k1;
      const a = w0 * samples[k0] + w1 * samples[at] + w2 * samples[k2] + w3 * samples[k3];
      const b = w0 * samples[k0 + 1] + w1 * samples[at + 1] + w2 * samples[k2 + 1] + w3 * samples[k3 + 1];
      view.write(i, a, b, outX, outZ);
    }
  }
}
