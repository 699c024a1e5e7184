/** The wind field of a forest: velocity and pressure at many places, at any moment, whatever the model. */
import { CosineGusts } from "./cosine";
import type { ResolvedWind, WindDocument } from "./document";
import { EddyGusts } from "./eddyGusts";
import type { Gusts, Output, Places } from "./frame";
import { changeWind, fieldKey, type Moment, steady, type WindState, windAt } from "./glide";
import { PerlinGusts } from "./perlin";
import { pressureOfVelocity } from "./pressure";
import { SpectralGusts } from "./spectral";

/** A glide needs two at once. */
const KEPT_GUSTS = 2;

export function gustsOf(wind: ResolvedWind): Gusts {
  switch (wind.model) {
    case "perlin":
      return new PerlinGusts(wind.seed);
    case "spectral":
      return new SpectralGusts(wind.seed, wind.beta);
    case "navier-stokes":
      return new EddyGusts(wind.seed);
    case "cosine":
      return new CosineGusts(wind);
  }
}

export class WindField {
  state: WindState;
  private readonly gusts = new Map<string, Gusts>();
  private otherX = new Float64Array(0);
  private otherZ = new Float64Array(0);
  private workX = new Float64Array(0);
  private workZ = new Float64Array(0);

  /** From a document (its air sets out at time 0) or from a shared state. */
  constructor(wind: WindDocument | WindState) {
    this.state = "wind" in wind ? wind : steady(wind);
  }

  /** Glides to another document from this time on. */
  change(wind: WindDocument, time_s: number): void {
    this.state = changeWind(this.state, wind, time_s);
  }

  /** The wind's numbers at a time, with glides on their way. */
  at(time_s: number): Moment {
    return windAt(this.state, time_s);
  }

  /** Writes the velocity (m/s, world x and z) at the reference height over each place. */
  velocity(x: Places, z: Places, time_s: number, outX: Output, outZ: Output): void {
    const moment = this.at(time_s);
    this.write(moment.wind, moment, x, z, outX, outZ);
    if (moment.share >= 1) return;
    if (this.otherX.length !== outX.length) {
      this.otherX = new Float64Array(outX.length);
      this.otherZ = new Float64Array(outX.length);
    }
    this.write(moment.before, moment, x, z, this.otherX, this.otherZ);
    for (let i = 0; i < outX.length; i++) {
      outX[i] += (1 - moment.share) * (this.otherX[i] - outX[i]);
      outZ[i] += (1 - moment.share) * (this.otherZ[i] - outZ[i]);
    }
  }

  /**
   * Writes the pressure (Pa, world x and z) at each place; exactly 0 where the wind is still.
   * `factor`: speed at the height of each place over that at the reference height (`heightFactor`).
   */
  pressure(x: Places, z: Places, time_s: number, outX: Output, outZ: Output, factor?: Places): void {
    if (this.workX.length !== outX.length) {
      this.workX = new Float64Array(outX.length);
      this.workZ = new Float64Array(outX.length);
    }
    this.velocity(x, z, time_s, this.workX, this.workZ);
    pressureOfVelocity(this.workX, this.workZ, outX, outZ, factor);
  }

  private write(wind: ResolvedWind, moment: Moment, x: Places, z: Places, outX: Output, outZ: Output): void {
    const carried = wind.model === "cosine" ? moment.time_s : moment.travel;
    this.gustsFor(wind).velocity(wind, carried, x, z, outX, outZ);
  }

  private gustsFor(wind: ResolvedWind): Gusts {
    const key = fieldKey(wind);
    let gusts = this.gusts.get(key);
    if (!gusts) {
      for (const old of this.gusts.keys()) if (this.gusts.size >= KEPT_GUSTS) this.gusts.delete(old);
      gusts = gustsOf(wind);
      this.gusts.set(key, gusts);
    }
    return gusts;
  }
}
