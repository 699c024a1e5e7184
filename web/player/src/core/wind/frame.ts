/** Coordinate frame of the gusts: along and across the wind, in units of the length scale, moving with the air. */
import { TURBULENCE_PER_GUSTINESS } from "../constants";
import type { ResolvedWind } from "./document";

/** An indexable array of numbers. */
export type Places = ArrayLike<number>;
export type Output = Float32Array | Float64Array;

/** Parameters of the inner loops; one object per model, rewritten every frame. */
export class View {
  cos = 1;
  sin = 0;
  cosPerM = 0;
  sinPerM = 0;
  /** Distance that the air has travelled, in length scales. */
  travel = 0;
  meanMS = 0;
  /** Standard deviation of the velocity along and across the wind. */
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

  /** Converts unit-variance fluctuations along and across the wind to a velocity (m/s, world x and z). */
  write(i: number, along: number, across: number, outX: Output, outZ: Output): void {
    const u = this.meanMS + this.alongMS * along;
    const v = this.acrossMS * across;
    outX[i] = u * this.cos - v * this.sin;
    outZ[i] = u * this.sin + v * this.cos;
  }
}

/** One model with one seed. `carried`: distance that the air has travelled, in length scales (cosine, recorded: time in s). */
export interface Gusts {
  /** Writes the velocity (m/s, world x and z) at each place. */
  velocity(wind: ResolvedWind, carried: number, x: Places, z: Places, outX: Output, outZ: Output): void;
}
