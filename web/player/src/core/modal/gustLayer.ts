/**
 * Motion of a tree's parts under gusts that differ from place to place in its crown: linear oscillators, in addition to
 * the modal model. Nothing is allocated per step.
 */
import { GUST_LAYER_REST, MAX_STEPS_PER_ADVANCE } from "../constants";
import type { Stepping } from "../motion/treeInstances";
import type { Table } from "../table/table";
import { CrownGusts } from "../wind/crown";
import { speedOfPressure_m_s } from "../wind/pressure";
import type { Moment } from "../wind/transition";

/** Trees whose gusts have faded out come to rest below this (m, m/s). */
const FADED_MOTION_M = 1e-3;

/** The gust layer of all trees of one table. */
export class GustLayer {
  readonly oscillators: number;
  /** Index of the first mode of the layer in a pose. */
  private readonly first: number;
  private readonly step: Float64Array;
  private readonly load: Float64Array;
  private readonly drag: Float64Array;
  private readonly place: Float64Array;
  private readonly e: Float64Array;
  private readonly v: Float64Array;
  private readonly now: Float64Array;
  private readonly before: Float64Array;
  /** [count] 1 while a tree moves. */
  private readonly moving: Uint8Array;
  private readonly gusts: Float64Array;
  private readonly local: Float64Array;
  private readonly exponent: number;
  private readonly field: CrownGusts;

  constructor({ gusts, metadata }: Table, count: number) {
    const oscillators = gusts.drag.length;
    this.oscillators = oscillators;
    this.first = metadata.modes - oscillators;
    this.exponent = metadata.streamlined_exponent;
    this.field = new CrownGusts(this.exponent);
    this.step = Float64Array.from(gusts.step);
    this.load = Float64Array.from(gusts.load);
    this.drag = Float64Array.from(gusts.drag);
    this.place = Float64Array.from(gusts.place);
    this.e = new Float64Array(count * oscillators);
    this.v = new Float64Array(count * oscillators);
    this.now = new Float64Array(count * oscillators);
    this.before = new Float64Array(count * oscillators);
    this.moving = new Uint8Array(count);
    this.gusts = new Float64Array((2 * gusts.place.length) / 3);
    this.local = new Float64Array(this.gusts.length);
  }

  /** Copies the state of trees from another layer of this table; `rows`: their index there, −1 for a new tree. */
  adopt(from: GustLayer, rows: Int32Array): void {
    const { oscillators: width } = this;
    rows.forEach((row, i) => {
      if (row < 0) return;
      this.moving[i] = from.moving[row];
      for (const name of ["e", "v", "now", "before"] as const) {
        this[name].set(from[name].subarray(row * width, (row + 1) * width), i * width);
      }
    });
  }

  /**
   * Advances all trees by one frame, before the modal model, whose phase they share. The pressures (Pa, world) are those
   * at the trees; `weight` [count] fades the gusts out (0..1). Writes the last modes of q.
   */
  advance(
    moment: Moment,
    trees: Stepping,
    pressureX: ArrayLike<number>,
    pressureZ: ArrayLike<number>,
    weight: ArrayLike<number> | null,
    q: Float32Array,
  ): void {
    const { oscillators, first, now, before, moving } = this;
    if (oscillators === 0) return;
    this.field.set(moment);
    const width = first + oscillators;
    for (let i = 0; i < moving.length; i++) {
      const share = weight ? weight[i] : 1;
      if (moving[i] === 0 && (share === 0 || !this.field.blows)) continue;
      const passed = trees.phase[i] + trees.rate / trees.size[i];
      if (passed >= 1) this.advanceTree(trees, i, Math.floor(passed), pressureX[i], pressureZ[i], share);
      const part = passed - Math.floor(passed);
      let at = i * oscillators;
      for (let k = i * width + first; k < (i + 1) * width; k++, at++) {
        q[k] = before[at] + (now[at] - before[at]) * part;
      }
    }
  }

  private advanceTree(
    trees: Stepping,
    i: number,
    steps: number,
    px: number,
    pz: number,
    share: number,
  ): void {
    const { gusts, local } = this;
    const strength = Math.sqrt(px * px + pz * pz);
    const c = trees.turn[2 * i];
    const s = trees.turn[2 * i + 1];
    const x = (c * px - s * pz) * share;
    const z = (s * px + c * pz) * share;
    this.field.write(this.place, trees, i, strength, gusts);
    for (let g = 0; g < local.length; g += 2) {
      local[g] = gusts[g] * x - gusts[g + 1] * z;
      local[g + 1] = gusts[g] * z + gusts[g + 1] * x;
    }
    const perSpeed = strength > 0 ? strength / speedOfPressure_m_s(strength, this.exponent) : 0;
    const small = share === 0 ? FADED_MOTION_M : strength === 0 ? GUST_LAYER_REST : 0;
    for (let n = Math.min(steps, MAX_STEPS_PER_ADVANCE); n > 0; n--) this.stepTree(i, perSpeed, small);
  }

  private stepTree(i: number, perSpeed: number, small: number): void {
    const { oscillators, step, load, drag, local, e, v, now, before } = this;
    const from = i * oscillators;
    let largest = 0;
    for (let k = 0, row = 0; k < oscillators; k++) {
      let force = 0;
      for (let g = 0; g < local.length; g++) force += load[row++] * local[g];
      const at = 6 * k;
      const x = e[from + k];
      const y = v[from + k];
      // implicit in the damping, so that any wind is stable
      const s1 = step[at + 5];
      const mean = y + 0.5 * (step[at + 2] * x + step[at + 3] * y + s1 * force);
      const damping = drag[k] * perSpeed;
      force -= (damping * mean) / (1 + 0.5 * damping * s1);
      e[from + k] = x + (step[at] * x + step[at + 1] * y + step[at + 4] * force);
      v[from + k] = y + (step[at + 2] * x + step[at + 3] * y + s1 * force);
      largest = Math.max(largest, Math.abs(e[from + k]), Math.abs(v[from + k]));
    }
    const rests = largest < small;
    if (rests) {
      e.fill(0, from, from + oscillators);
      v.fill(0, from, from + oscillators);
    }
    let still = rests;
    for (let k = from; k < from + oscillators; k++) {
      before[k] = now[k];
      now[k] = e[k];
      still = still && before[k] === 0;
    }
    this.moving[i] = still ? 0 : 1;
  }
}
