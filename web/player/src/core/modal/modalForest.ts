/**
 * The modal reduced-order model for many trees at once: a few oscillators per tree, integrated exactly and coupled by
 * a small polynomial force. Nothing is allocated per step.
 *
 * There are four implementations of the modal step, which must stay equal: numba (precompute/galewood/motion/modal/),
 * this one, AssemblyScript (web/kernel/modal.ts) and WGSL (webgpu/step/modalWgsl.ts). See docs/design/0010-kernel.md.
 */

import { MODAL_REACH, MODAL_REST } from "../constants";
import { type Numbers, TreeInstances } from "../motion/treeInstances";
import type { Table } from "../table/table";
import { addRows } from "./addRows";
import { ModalDrag } from "./modalDrag";
import { type KernelModel, ModalKernel } from "./modalKernel";
import { coupledOf, forceTerms, meanGust, poseTerms } from "./modalTensors";
import { ModalTerms } from "./modalTerms";

/** Trees of one table, each with its own state, orientation and time scale. */
export class ModalForest extends TreeInstances {
  /** [count] sway and pressure over their largest sampled values; above 1 the tree is beyond the sampled range. */
  readonly extrapolationRatio: Float32Array;
  protected readonly d: number;
  private readonly c: number;
  private readonly stepOf: Float64Array;
  private readonly load: Float64Array;
  private readonly sway: Float64Array;
  private readonly force: Float64Array;
  private readonly shownOf: Float64Array;
  private readonly pose: Float64Array;
  private readonly limits: Float64Array;
  private readonly drag: ModalDrag;
  /** Views of `states`: displacements and speeds of the oscillators; `own`: d, padded to whole SIMD vectors in the kernel. */
  private readonly e: Numbers;
  protected readonly v: Numbers;
  protected readonly own: number;
  protected readonly kernel: ModalKernel | null;
  private readonly ahead: Float64Array;
  private readonly polynomial: ModalTerms;
  private readonly total: Float64Array;
  private readonly further: Float64Array;
  /** [G] weights of the places in the mean gust, and [d, 2, G] load of the gusts. */
  private readonly mean: Float64Array;
  private readonly placeLoad: Float64Array;
  /** [2, G] gusts at the places of the tree that steps, Pa. */
  private readonly local: Numbers;

  /**
   * `plain`: use this double-precision implementation even where the kernel is available. `coarse`: further models for the
   * kernel.
   */
  constructor(table: Table, count: number, plain = false, coarse: readonly KernelModel[] = []) {
    const { modal, metadata } = table;
    const { modes, dt_s } = metadata;
    const kernel = plain ? null : ModalKernel.make([{ modal, modes, dt_s }, ...coarse], count);
    const d = modal.step.length / 6;
    const own = kernel?.own ?? d;
    super(count, modes, dt_s, kernel?.states ?? new Float64Array(count * 2 * (d + modes)), 2 * own);
    this.d = d;
    this.kernel = kernel;
    this.own = own;
    this.stepOf = Float64Array.from(modal.step);
    this.load = Float64Array.from(modal.load);
    this.sway = Float64Array.from(modal.sway);
    this.force = Float64Array.from(modal.force);
    this.shownOf = Float64Array.from(modal.shown);
    this.pose = Float64Array.from(modal.pose);
    this.limits = Float64Array.from(modal.limits);
    this.drag = new ModalDrag(modal);
    this.e = this.states;
    this.v = this.states.subarray(own);
    this.extrapolationRatio = new Float32Array(count);
    this.ahead = new Float64Array(d);
    this.c = coupledOf(modal.limits.length);
    this.polynomial = new ModalTerms(modal, dt_s);
    this.total = new Float64Array(d);
    this.further = new Float64Array(this.r - d);
    this.mean = meanGust(modal);
    this.placeLoad = Float64Array.from(modal.placeLoad);
    this.local = kernel?.local ?? new Float64Array(2 * this.mean.length);
  }

  /** Whether the kernel steps these trees. */
  get compiled(): boolean {
    return this.kernel !== null;
  }

  /** Copies the state of trees from another forest of this table; `rows`: their index there, −1 for a new tree. */
  adopt(from: ModalForest, rows: Int32Array): void {
    // The state layouts differ if one forest could not allocate a kernel: the trees start at rest.
    if (from.compiled !== this.compiled) return;
    rows.forEach((row, i) => {
      if (row < 0) return;
      this.takeOver(i, from, row);
      this.extrapolationRatio[i] = from.extrapolationRatio[row];
    });
  }

  /**
   * Starts tree i at a pose [r] (m) that changes by `rate` [r] (m/s) under a world pressure (Pa). The oscillators
   * determine the further modes, so its first pose may differ a little.
   */
  startAt(i: number, pose: Float32Array, rate: Float32Array, pressureX: number, pressureZ: number): void {
    const { d, width, e, v, shownOf, dt } = this;
    for (let k = 0; k < d; k++) {
      const unit = shownOf[k] === 0 ? 0 : 1 / shownOf[k];
      // A tree s times as large sways s times slower.
      v[i * width + k] = unit * rate[k] * this.sizeOf(i);
      e[i * width + k] = unit * pose[k] - dt * v[i * width + k];
    }
    this.rotatePressure(i, pressureX, pressureZ);
    // From the step before to the start, and to the next step: the tree is displayed between these two.
    for (let steps = 0; steps < 2; steps++) this.step(i, this.localPressure.px, this.localPressure.pz);
  }

  /** Adds to the coordinates e and speeds v [d] of tree i, per second of a tree of this size. */
  displace(i: number, e: ArrayLike<number>, v: ArrayLike<number>): void {
    const { d, width, now, before, shownOf } = this;
    for (let k = 0; k < d; k++) {
      this.e[i * width + k] += e[k];
      this.v[i * width + k] += v[k] * this.sizeOf(i);
      now[i * width + k] += shownOf[k] * e[k];
      before[i * width + k] += shownOf[k] * e[k];
    }
  }

  protected step(i: number, px: number, pz: number): void {
    const gusty = this.gusts?.write(this.standing, i, px, pz, this.local) ?? false;
    const places = gusty ? this.mean.length : 0;
    if (this.kernel) this.stepBy(0, i, px, pz, places);
    else this.stepPlainly(i, px, pz, places);
  }

  /** A step of the kernel by a model. */
  protected stepBy(model: number, i: number, px: number, pz: number, places: number): void {
    const { kernel } = this;
    if (kernel) this.extrapolationRatio[i] = kernel.step(kernel.models[model], i, px, pz, places);
  }

  /** `places`: G, or 0 if there are no gusts. */
  private stepPlainly(i: number, px: number, pz: number, places: number): void {
    const { d, e, v, stepOf, total, mean, local, polynomial } = this;
    const first = i * this.width;
    let feltX = px;
    let feltZ = pz;
    for (let g = 0; g < places; g++) {
      feltX += mean[g] * local[g];
      feltZ += mean[g] * local[places + g];
    }
    polynomial.writeForce(e, v, first, feltX, feltZ);
    this.writeLoads(px, pz, places);
    addRows(this.force, polynomial.terms, forceTerms(this.c), d, total);
    this.drag.setWind(px, pz, places, local);
    this.addDrag(first);
    for (let k = 0; k < d; k++) {
      const a = e[first + k];
      const b = v[first + k];
      const f = total[k];
      const at = 6 * k;
      e[first + k] = a + (stepOf[at] * a + stepOf[at + 1] * b + stepOf[at + 4] * f);
      v[first + k] = b + (stepOf[at + 2] * a + stepOf[at + 3] * b + stepOf[at + 5] * f);
    }
    if (px === 0 && pz === 0 && this.isAtRest(first)) {
      e.fill(0, first, first + d);
      v.fill(0, first, first + d);
    }
    const strength = Math.sqrt(px * px + pz * pz);
    this.writePose(i, feltX, feltZ, strength);
  }

  /** The forces of the wind on the tree at rest, into `total`. */
  private writeLoads(px: number, pz: number, places: number): void {
    const { d, load, total, placeLoad, local } = this;
    for (let k = 0, at = 0; k < d; k++) {
      total[k] = load[2 * k] * px + load[2 * k + 1] * pz;
      for (let g = 0; g < 2 * places; g++) total[k] += placeLoad[at++] * local[g];
    }
  }

  /** Adds the drag at the mean speed during the step, without the drag, to `total`. */
  private addDrag(first: number): void {
    const { d, e, v, stepOf, total, ahead, dt } = this;
    for (let k = 0; k < d; k++) {
      const at = 6 * k;
      const path = stepOf[at] * e[first + k] + stepOf[at + 1] * v[first + k] + stepOf[at + 4] * total[k];
      ahead[k] = path / dt;
    }
    this.drag.add(ahead, total);
  }

  /** Whether the motion is negligible, so that a tree in still air can be set to rest. */
  private isAtRest(first: number): boolean {
    const { d, e, sway, limits, polynomial } = this;
    const { pair } = polynomial;
    const small = MODAL_REST * limits[0];
    polynomial.projectOnSway(e, first);
    if (Math.max(Math.abs(pair[0]), Math.abs(pair[1])) > small) return false;
    polynomial.projectOnSway(this.v, first);
    if (Math.max(Math.abs(pair[0]), Math.abs(pair[1])) > MODAL_REST * limits[1]) return false;
    let largest = 0;
    for (let k = 0; k < d; k++) largest = Math.max(largest, Math.abs(e[first + k]));
    return largest * Math.max(Math.abs(sway[0]), Math.abs(sway[d])) < small;
  }

  /**
   * Writes the pose of the current state, keeps the previous one, and updates the extrapolation ratio. (px, pz): mean
   * pressure over the crown; `strength_pa`: that at the tree.
   */
  private writePose(i: number, px: number, pz: number, strength_pa: number): void {
    const { d, c, r, e, polynomial, limits, now, before, further, shownOf } = this;
    const { terms, pair } = polynomial;
    const first = i * this.width;
    for (let k = 0; k < d; k++) terms[k] = e[first + k];
    terms[d] = px;
    terms[d + 1] = pz;
    polynomial.projectOnSway(e, first);
    const sway = Math.sqrt(pair[0] * pair[0] + pair[1] * pair[1]) / limits[0];
    this.extrapolationRatio[i] = Math.max(sway, strength_pa / limits[2]);
    polynomial.clampPair(MODAL_REACH * limits[0]);
    polynomial.writeShape(pair[0], pair[1], e, first, d + 2);
    further.fill(0);
    addRows(this.pose, terms, poseTerms(d, c), r - d, further);
    for (let k = 0; k < r; k++) {
      before[first + k] = now[first + k];
      now[first + k] = k < d ? shownOf[k] * terms[k] : further[k - d];
    }
  }

  protected show(i: number, part: number): void {
    const { now, before, q, d, width } = this;
    let from = i * width;
    let at = i * this.r;
    for (const end = at + d; at < end; at++, from++) q[at] = before[from] + (now[from] - before[from]) * part;
    from = i * width + this.own;
    for (const end = (i + 1) * this.r; at < end; at++, from++) {
      q[at] = before[from] + (now[from] - before[from]) * part;
    }
  }
}
