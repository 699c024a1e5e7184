/** The wind at the trees of one group, written into pose buffers. Nothing is allocated per frame. */

import { compression, dynamicPressure, heightFactor, pressurePerSpeed } from "../wind/pressure";
import type { Moment } from "../wind/transition";
import { poseStride } from "./poseStride";

/** The trees of a group whose wind is evaluated; null: all. */
export type Chosen = Uint32Array | null;

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
  protected readonly factor: Float64Array;
  /** Speed of the strongest gusts at the reference height. */
  private gust_m_s = Number.NaN;
  private gusty = false;
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
    this.factor = new Float64Array(this.count).fill(1);
  }

  column(channel: 0 | 1 | 2 | 3): Float32Array {
    return Float32Array.from({ length: this.count }, (_, tree) => this.placement[tree * 4 + channel]);
  }

  /** Writes where trees stand, from `first` on. */
  place(trees: Chosen, x: Float64Array, z: Float64Array, first: number): void {
    const count = trees?.length ?? this.count;
    for (let k = 0; k < count; k++) {
      const tree = trees ? trees[k] : k;
      x[first + k] = this.x[tree];
      z[first + k] = this.z[tree];
    }
  }

  /** Takes the velocities (m/s) at these trees, which begin at `first`. */
  take(moment: Moment, trees: Chosen, x: Float64Array, z: Float64Array, first: number): void {
    this.begin(moment);
    const count = trees?.length ?? this.count;
    let beyond = 0;
    let strongest = 0;
    for (let k = 0; k < count; k++) {
      const ratio = this.press(trees ? trees[k] : k, x[first + k], z[first + k]);
      if (ratio > strongest) strongest = ratio;
      if (ratio > 1) beyond++;
    }
    this.coverage = count === 0 ? 1 : 1 - beyond / count;
    this.extrapolationRatio = strongest;
  }

  /**
   * Takes the profile of a wind, and whether its strongest gusts exceed the sampled range somewhere: then pressures
   * within it are scaled, too.
   */
  private begin({ wind }: Moment): void {
    const same = this.hasProfile(wind.height_exponent, wind.reference_height_m);
    const gust_m_s = wind.mean_speed_m_s * (1 + wind.gustiness);
    if (same && gust_m_s === this.gust_m_s) return;
    this.gust_m_s = gust_m_s;
    this.gusty = !this.clamps && this.pressure_pa(gust_m_s * this.tallest) > this.sampledPeak_pa;
  }

  /**
   * Sets the pressure at a tree by the velocity (m/s) at the reference height, limited to the sampled range, or nearly so. Returns the pressure without
   * that limit relative to the sampled maximum.
   */
  protected press(tree: number, x: number, z: number): number {
    const { pressureX, pressureZ, factor } = this;
    const vx = x * factor[tree];
    const vz = z * factor[tree];
    const speed_m_s = Math.sqrt(vx * vx + vz * vz);
    this.speed_m_s[tree] = speed_m_s;
    let perSpeed = pressurePerSpeed(speed_m_s, this.streamlined);
    const ratio = (perSpeed * speed_m_s) / this.sampledPeak_pa;
    if (ratio > 1 || this.gusty) perSpeed *= this.shareAt(tree, ratio);
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

  /** Wind speed grows with height; returns whether it did so before. */
  private hasProfile(exponent: number, reference_m: number): boolean {
    if (exponent === this.exponent && reference_m === this.reference_m) return true;
    this.exponent = exponent;
    this.reference_m = reference_m;
    for (let tree = 0; tree < this.count; tree++) {
      this.factor[tree] = heightFactor(this.height_m * this.placement[tree * 4 + 3], exponent, reference_m);
    }
    this.tallest = this.factor.reduce((a, b) => Math.max(a, b), 0);
    return false;
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
