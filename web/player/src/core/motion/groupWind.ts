/** The wind at the trees of one group, written into pose buffers. Nothing is allocated per frame. */

import type { WindField } from "../wind/field";
import { compression, dynamicPressure, heightFactor, pressurePerSpeed } from "../wind/pressure";
import type { Moment } from "../wind/transition";
import { poseStride } from "./poseStride";

export class GroupWind {
  readonly count: number;
  readonly x: Float32Array;
  readonly z: Float32Array;
  readonly pressureX: Float32Array;
  readonly pressureZ: Float32Array;

  /** Share of the trees within the sampled range of winds. */
  coverage = 1;
  /** Largest pressure relative to the sampled maximum. */
  extrapolationRatio = 0;
  private readonly speed_m_s: Float32Array;
  protected readonly velocityX: Float64Array;
  protected readonly velocityZ: Float64Array;
  protected readonly factor: Float64Array;
  /** Speed of the strongest gusts at the reference height. */
  private gust_m_s = 0;
  private exponent = 0;
  private reference_m = 1;
  private tallest = 1;

  /**
   * `placement`: x, z, yaw, scale of each tree; `height_m`: height of a tree of scale 1; `streamlined`: exponent of the
   * pressure (`dynamicPressure`). Pressures beyond the sampled peak are compressed, or clamped to it for the paper's
   * state search, whose records end there.
   */
  constructor(
    readonly placement: Float32Array,
    private readonly height_m: number,
    private readonly sampledPeak_pa: number,
    private readonly streamlined: number,
    private readonly clamps = false,
  ) {
    this.count = placement.length / 4;
    this.x = this.column(0);
    this.z = this.column(1);
    this.pressureX = new Float32Array(this.count);
    this.pressureZ = new Float32Array(this.count);
    this.speed_m_s = new Float32Array(this.count);
    this.velocityX = new Float64Array(this.count);
    this.velocityZ = new Float64Array(this.count);
    this.factor = new Float64Array(this.count).fill(1);
  }

  column(channel: 0 | 1 | 2 | 3): Float32Array {
    return Float32Array.from({ length: this.count }, (_, tree) => this.placement[tree * 4 + channel]);
  }

  /** Evaluates the wind at all trees. */
  update(field: WindField, moment: Moment): void {
    const gusty = this.begin(moment);
    field.velocity(this.x, this.z, moment, this.velocityX, this.velocityZ);
    let beyond = 0;
    let strongest = 0;
    for (let tree = 0; tree < this.count; tree++) {
      const ratio = this.press(tree, gusty);
      if (ratio > strongest) strongest = ratio;
      if (ratio > 1) beyond++;
    }
    this.coverage = this.count === 0 ? 1 : 1 - beyond / this.count;
    this.extrapolationRatio = strongest;
  }

  /**
   * Takes the profile of a wind. Returns whether its strongest gusts exceed the sampled range somewhere: then pressures
   * within it are scaled, too.
   */
  protected begin({ wind }: Moment): boolean {
    this.setProfile(wind.height_exponent, wind.reference_height_m);
    this.gust_m_s = wind.mean_speed_m_s * (1 + wind.gustiness);
    return !this.clamps && this.pressure_pa(this.gust_m_s * this.tallest) > this.sampledPeak_pa;
  }

  /**
   * Sets the pressure at a tree by its velocity, limited to the sampled range, or nearly so. Returns the pressure without
   * that limit relative to the sampled maximum.
   */
  protected press(tree: number, gusty: boolean): number {
    const { pressureX, pressureZ, velocityX, velocityZ, factor } = this;
    const vx = velocityX[tree] * factor[tree];
    const vz = velocityZ[tree] * factor[tree];
    const speed_m_s = Math.sqrt(vx * vx + vz * vz);
    this.speed_m_s[tree] = speed_m_s;
    let perSpeed = pressurePerSpeed(speed_m_s, this.streamlined);
    const ratio = (perSpeed * speed_m_s) / this.sampledPeak_pa;
    if (ratio > 1 || gusty) perSpeed *= this.shareAt(tree, ratio);
    pressureX[tree] = perSpeed * vx;
    pressureZ[tree] = perSpeed * vz;
    return ratio;
  }

  /** Factor of the pressure at a tree, which is `ratio` times the sampled peak. */
  private shareAt(tree: number, ratio: number): number {
    if (this.clamps) return ratio > 1 ? 1 / ratio : 1;
    return compression(ratio, this.pressure_pa(this.gust_m_s * this.factor[tree]) / this.sampledPeak_pa);
  }

  /** Pressure at one tree relative to the sampled maximum. */
  extrapolationRatioAt(tree: number): number {
    return this.pressure_pa(this.speed_m_s[tree]) / this.sampledPeak_pa;
  }

  private pressure_pa(speed_m_s: number): number {
    return dynamicPressure(speed_m_s, this.streamlined);
  }

  /** Wind speed grows with height. */
  private setProfile(exponent: number, reference_m: number): void {
    if (exponent === this.exponent && reference_m === this.reference_m) return;
    this.exponent = exponent;
    this.reference_m = reference_m;
    for (let tree = 0; tree < this.count; tree++) {
      this.factor[tree] = heightFactor(this.height_m * this.placement[tree * 4 + 3], exponent, reference_m);
    }
    this.tallest = this.factor.reduce((a, b) => Math.max(a, b), 0);
  }

  /** Wind speed at a tree, m/s. */
  speedAt_m_s(tree: number): number {
    return this.speed_m_s[tree];
  }

  /** Writes each tree's wind speed (m/s) into its row, after the modes. */
  writeSpeeds(out: Float32Array, modes: number): void {
    const stride = poseStride(modes);
    for (let tree = 0; tree < this.count; tree++) out[tree * stride + modes] = this.speed_m_s[tree];
  }
}

/** Share of all trees within the sampled range of winds. */
export function coverageOf(groups: readonly GroupWind[]): number {
  const trees = groups.reduce((sum, { count }) => sum + count, 0);
  return trees === 0 ? 1 : groups.reduce((sum, group) => sum + group.count * group.coverage, 0) / trees;
}

export const extrapolationRatioOf = (groups: readonly GroupWind[]): number =>
  groups.reduce((most, { extrapolationRatio }) => Math.max(most, extrapolationRatio), 0);
