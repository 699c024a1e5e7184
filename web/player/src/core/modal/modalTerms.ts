import { MODAL_REACH } from "../constants";
import type { Numbers } from "../motion/treeInstances";
import { coupledOf, forceTerms, type ModalTensors, poseTerms } from "./modalTensors";

/** The terms of the polynomials for one tree after the other, in double precision. Nothing is allocated per step. */
export class ModalTerms {
  /** The terms that were written last. */
  readonly terms: Float64Array;
  /** Return value of methods that return a pair. */
  readonly pair = new Float64Array(2);
  private readonly d: number;
  private readonly c: number;
  private readonly sway: Float64Array;
  private readonly limits: Float64Array;
  private readonly ahead: Float64Array;

  constructor(
    modal: ModalTensors,
    private readonly dt: number,
  ) {
    this.d = modal.step.length / 6;
    this.c = coupledOf(modal.limits.length);
    this.sway = Float64Array.from(modal.sway);
    this.limits = Float64Array.from(modal.limits);
    this.ahead = new Float64Array(this.d);
    this.terms = new Float64Array(Math.max(forceTerms(this.c), poseTerms(this.d, this.c)));
  }

  /** The two sway coordinates of a row of `values`, into `pair`. */
  projectOnSway(values: Numbers, first: number): void {
    const { d, sway, pair } = this;
    let x = 0;
    let y = 0;
    for (let k = 0; k < d; k++) {
      x += sway[k] * values[first + k];
      y += sway[d + k] * values[first + k];
    }
    pair[0] = x;
    pair[1] = y;
  }

  /** Limits the length of `pair` to `far`. */
  clampPair(far: number): void {
    const { pair } = this;
    const size = Math.sqrt(pair[0] * pair[0] + pair[1] * pair[1]);
    if (!(size > far)) return;
    pair[0] *= far / size;
    pair[1] *= far / size;
  }

  /** Terms in the pose alone, from `at` on: sway of degree 2 and 3, each coupled coordinate times the sway. */
  writeShape(x: number, y: number, values: Numbers, first: number, at: number): void {
    const { c, terms, limits } = this;
    const xx = x * x;
    const xy = x * y;
    const yy = y * y;
    terms[at] = xx;
    terms[at + 1] = xy;
    terms[at + 2] = yy;
    terms[at + 3] = xx * x;
    terms[at + 4] = xx * y;
    terms[at + 5] = x * yy;
    terms[at + 6] = yy * y;
    for (let j = 0; j < c; j++) {
      const far = MODAL_REACH * limits[3 + j];
      const z = Math.min(Math.max(values[first + 2 + j], -far), far);
      terms[at + 7 + 2 * j] = z * x;
      terms[at + 8 + 2 * j] = z * y;
    }
  }

  /** All terms of the force at the midpoint of the step, extrapolated from the current state; (px, pz): mean pressure. */
  writeForce(e: Numbers, v: Numbers, first: number, px: number, pz: number): void {
    const { d, ahead, limits, pair } = this;
    const half = this.dt / 2;
    for (let k = 0; k < d; k++) ahead[k] = e[first + k] + half * v[first + k];
    this.projectOnSway(ahead, 0);
    this.clampPair(MODAL_REACH * limits[0]);
    const x = pair[0];
    const y = pair[1];
    this.writeShape(x, y, ahead, 0, 0);
    const at = 7 + 2 * this.c;
    this.projectOnSway(v, first);
    this.clampPair(MODAL_REACH * limits[1]);
    this.writeSquares(x, y, at);
    this.writeProducts(x, y, 3, at + 9);
    pair[0] = px;
    pair[1] = pz;
    this.clampPair(MODAL_REACH * limits[2]);
    this.writeProducts(x, y, 7, at + 19);
    this.writeCoupled(x, y, v, first, at + 37);
  }

  /** The velocity of each coupled coordinate times the sway, and the coordinate times the pressure in `pair`. */
  private writeCoupled(x: number, y: number, v: Numbers, first: number, at: number): void {
    const { c, ahead, terms, limits, pair } = this;
    for (let j = 0, to = at; j < c; j++) {
      const far = MODAL_REACH * limits[3 + j];
      const fast = MODAL_REACH * limits[3 + c + j];
      const z = Math.min(Math.max(ahead[2 + j], -far), far);
      const w = Math.min(Math.max(v[first + 2 + j], -fast), fast);
      terms[to++] = w * x;
      terms[to++] = w * y;
      terms[to++] = z * pair[0];
      terms[to++] = z * pair[1];
    }
  }

  /** Products of the sway velocity in `pair` with itself, and these times the sway, from `at` on. */
  private writeSquares(x: number, y: number, at: number): void {
    const { terms, pair } = this;
    const a = pair[0] * pair[0];
    const b = pair[0] * pair[1];
    const c = pair[1] * pair[1];
    terms[at] = a;
    terms[at + 1] = b;
    terms[at + 2] = c;
    terms[at + 3] = a * x;
    terms[at + 4] = a * y;
    terms[at + 5] = b * x;
    terms[at + 6] = b * y;
    terms[at + 7] = c * x;
    terms[at + 8] = c * y;
  }

  /** `pair` times the sway and times the first `shapes` of its higher terms, from `at` on. */
  private writeProducts(x: number, y: number, shapes: number, at: number): void {
    const { terms, pair } = this;
    for (let side = 0, to = at; side < 2; side++) {
      const factor = pair[side];
      terms[to++] = factor * x;
      terms[to++] = factor * y;
      for (let k = 0; k < shapes; k++) terms[to++] = factor * terms[k];
    }
  }
}
