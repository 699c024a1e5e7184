/** Wind field of a forest: velocity and pressure at many positions, for every model. */

import { TIMED_MODELS } from "../constants";
import type { ResolvedWind, WindDocument } from "./document";
import type { Gusts, Output, Places } from "./frame";
import { addFronts } from "./fronts";
import { CosineGusts } from "./models/cosine";
import { EddyGusts } from "./models/eddyGusts";
import { PerlinGusts } from "./models/perlin";
import { RecordedGusts } from "./models/recorded";
import { SpectralGusts } from "./models/spectral";
import { pressureOfVelocity } from "./pressure";
import { changeWind, fieldKey, type Moment, steady, type WindState, windAt } from "./transition";

const TIMED_NAMES: readonly string[] = TIMED_MODELS;
/** One set per species of the forest, and some for the instruments. */
const KEPT_BUFFERS = 12;

function gustsOf(wind: ResolvedWind): Gusts {
  switch (wind.model) {
    case "perlin":
      return new PerlinGusts(wind.seed);
    case "spectral":
      return new SpectralGusts(wind.seed, wind.beta);
    case "navier-stokes":
      return new EddyGusts(wind.seed);
    case "recorded":
      return new RecordedGusts(wind.recording);
    case "cosine":
      return new CosineGusts(wind);
  }
}

export class WindField {
  state: WindState;
  private readonly gusts = new Map<string, Gusts>();
  /** Buffers by number of positions, reused between frames: other x, other z, work x, work z. */
  private readonly spare = new Map<number, Float64Array[]>();

  /** Starts from a document (constant since time 0) or from a shared state. */
  constructor(wind: WindDocument | WindState) {
    this.state = "wind" in wind ? wind : steady(wind);
  }

  /** Starts a transition to another document at this time. */
  change(wind: WindDocument, time_s: number): void {
    this.state = changeWind(this.state, wind, time_s);
  }

  /** The parameters of the wind at a time, transitions included. */
  at(time_s: number): Moment {
    return windAt(this.state, time_s);
  }

  /** Writes the velocity (m/s, world x and z) at the reference height above each position; `moment`: of this field. */
  velocity(x: Places, z: Places, moment: Moment, outX: Output, outZ: Output): void {
    this.write(moment.wind, moment, x, z, outX, outZ);
    if (moment.share < 1) this.mixBefore(moment, x, z, outX, outZ);
    if (this.state.fronts) addFronts(this.state.fronts, x, z, moment.time_s, outX, outZ);
  }

  /** Mixes in the velocity of the model that is fading out. */
  private mixBefore(moment: Moment, x: Places, z: Places, outX: Output, outZ: Output): void {
    const [otherX, otherZ] = this.buffers(outX.length);
    this.write(moment.before, moment, x, z, otherX, otherZ);
    for (let i = 0; i < outX.length; i++) {
      outX[i] += (1 - moment.share) * (otherX[i] - outX[i]);
      outZ[i] += (1 - moment.share) * (otherZ[i] - outZ[i]);
    }
  }

  /**
   * Writes the pressure (Pa, world x and z) at each position; exactly 0 in still air.
   * `exponent`: that of the trees (`dynamicPressure`). `factor`: wind speed at the height of each position relative to
   * the reference height (`heightFactor`).
   */
  pressure(
    x: Places,
    z: Places,
    moment: Moment,
    outX: Output,
    outZ: Output,
    exponent: number,
    factor?: Places,
  ): void {
    const [, , workX, workZ] = this.buffers(outX.length);
    this.velocity(x, z, moment, workX, workZ);
    pressureOfVelocity(workX, workZ, outX, outZ, exponent, factor);
  }

  private buffers(count: number): Float64Array[] {
    let buffers = this.spare.get(count);
    if (!buffers) {
      if (this.spare.size >= KEPT_BUFFERS) this.spare.clear();
      buffers = Array.from({ length: 4 }, () => new Float64Array(count));
      this.spare.set(count, buffers);
    }
    return buffers;
  }

  private write(wind: ResolvedWind, moment: Moment, x: Places, z: Places, outX: Output, outZ: Output): void {
    const carried = TIMED_NAMES.includes(wind.model) ? moment.time_s : moment.travel;
    this.gustsFor(wind, moment).velocity(wind, carried, x, z, outX, outZ);
  }

  private gustsFor(wind: ResolvedWind, { before, wind: after }: Moment): Gusts {
    const key = fieldKey(wind);
    let gusts = this.gusts.get(key);
    if (!gusts) {
      const needed = [fieldKey(before), fieldKey(after)];
      for (const old of this.gusts.keys()) if (!needed.includes(old)) this.gusts.delete(old);
      gusts = gustsOf(wind);
      this.gusts.set(key, gusts);
    }
    return gusts;
  }
}
