/** The frame of the gusts: along and across the wind, in length scales, moving with the air. */
import type { ResolvedWind } from "./document";

/** Standard deviation of the speed over its mean at gustiness 1. */
export const TURBULENCE_PER_GUSTINESS = 0.308;

/** Numbers to read from or write to, by index. */
export type Places = ArrayLike<number>;
export type Output = Float32Array | Float64Array;

/** What the inner loops need to place gusts; one for each model, rewritten every frame. */
export class View {
  cos = 1;
  sin = 0;
  cosPerM = 0;
  sinPerM = 0;
  /** Length scales that the air has travelled. */
  travel = 0;
  meanMS = 0;
  /** Standard deviation of the speed along the wind, and across it. */
  alongMS = 0;
  acrossMS = 0;

  constructor(private readonly lateralShare: number) {}

  set(wind: ResolvedWind, travel: number): void {
    const heading = (wind.direction_deg * Math.PI) / 180;
    this.cos = Math.cos(heading);
    this.sin = Math.sin(heading);
    this.cosPerM = this.cos / wind.length_scale_m;
    this.sinPerM = this.sin / wind.length_scale_m;
    this.travel = travel;
    this.meanMS = wind.mean_speed_m_s;
    this.alongMS = wind.mean_speed_m_s * TURBULENCE_PER_GUSTINESS * wind.gustiness;
    this.acrossMS = this.alongMS * this.lateralShare;
  }

  /** The velocity (m/s, world x and z) of unit-variance fluctuations along and across the wind. */
  write(i: number, along: number, across: number, outX: Output, outZ: Output): void {
    const u = this.meanMS + this.alongMS * along;
    const v = this.acrossMS * across;
    outX[i] = u * this.cos - v * this.sin;
    outZ[i] = u * this.sin + v * this.cos;
  }
}

/** One model with one seed. `carried`: the length scales that the air has travelled (cosine: the time in s). */
export interface Gusts {
  /** Writes the velocity (m/s, world x and z) at each place. */
  velocity(wind: ResolvedWind, carried: number, x: Places, z: Places, outX: Output, outZ: Output): void;
}
