/**
 * A coarse model of distant trees: the leading oscillators of a table alone, stepped several table steps at once. Pure.
 *
 * Each oscillator's step under a constant force is exact, and so is its composition: [e, v] → R [e, v] + s f applied n
 * times is Rⁿ and (1 + R + … + Rⁿ⁻¹) s. Only the nonlinear terms, which are taken at the middle of a step, are coarser. Of the
 * modes that follow the oscillators it keeps the first, by which a bent tree loses height.
 */
import type { KernelModel } from "./modalKernel";
import { coupledOf, type ModalTensors, poseTerms } from "./modalTensors";

/** Sway coordinates of the force's terms, before the coupled ones. */
const SWAY_ROWS = 2;

/** [d, 6] `steps` steps of each oscillator in one, for the first d of them. */
function composed(step: Float32Array, d: number, steps: number): Float32Array {
  const out = new Float32Array(6 * d);
  for (let k = 0; k < d; k++) {
    const [a, b, c, e, s0, s1] = step.subarray(6 * k, 6 * k + 6);
    let [r00, r01, r10, r11] = [1, 0, 0, 1];
    let [f0, f1] = [0, 0];
    for (let n = 0; n < steps; n++) {
      [f0, f1] = [f0 + a * f0 + b * f1 + s0, f1 + c * f0 + e * f1 + s1];
      [r00, r10] = [r00 + a * r00 + b * r10, r10 + c * r00 + e * r10];
      [r01, r11] = [r01 + a * r01 + b * r11, r11 + c * r01 + e * r11];
    }
    out.set([r00 - 1, r01, r10, r11 - 1, f0, f1], 6 * k);
  }
  return out;
}

/** The first `kept` columns of these rows of a matrix, of all rows by default. */
function leading(matrix: Float32Array, width: number, kept: number, rows?: readonly number[]): Float32Array {
  const all = rows ?? range(0, width === 0 ? 0 : matrix.length / width);
  return Float32Array.from(all.flatMap((row) => [...matrix.subarray(row * width, row * width + kept)]));
}

const range = (from: number, count: number) => Array.from({ length: count }, (_, k) => from + k);

/** The rows of the force without those of coupled coordinates from `kept` on; the order is that of `ModalTerms`. */
const forceRows = (coupled: number, kept: number): number[] => [
  ...range(0, 7 + 2 * kept),
  ...range(7 + 2 * coupled, 37),
  ...range(44 + 2 * coupled, 4 * kept),
];

/** Drag points of a coarse model: one vector of the kernel. */
const COARSE_POINTS = 4;

/** The drag points merged to few: those that the first two oscillators move alike, by their areas. */
function mergedDrag({ dragPoint, dragShape, dragRest }: ModalTensors, all: number, d: number) {
  const m = dragPoint.length / 2;
  const points = Math.min(COARSE_POINTS, m);
  const reach = (j: number) =>
    range(0, 3).reduce((sum, side) => {
      const at = (side * m + j) * all;
      return sum + dragShape[at] ** 2 + (all > 1 ? dragShape[at + 1] ** 2 : 0);
    }, 0);
  const order = range(0, m).sort((a, b) => reach(a) - reach(b));
  const point = new Float32Array(2 * points);
  const shape = new Float32Array(3 * points * d);
  for (const [rank, j] of order.entries()) point[2 * Math.floor((rank * points) / m)] += dragPoint[2 * j];
  for (const [rank, j] of order.entries()) {
    const to = Math.floor((rank * points) / m);
    const weight = point[2 * to] > 0 ? dragPoint[2 * j] / point[2 * to] : 0;
    point[2 * to + 1] += weight * dragPoint[2 * j + 1];
    for (let side = 0; side < 3; side++)
      for (let k = 0; k < d; k++)
        shape[(side * points + to) * d + k] += weight * dragShape[(side * m + j) * all + k];
  }
  return { dragPoint: point, dragShape: shape, dragRest: dragRest.subarray(0, d) };
}

/** The model of the first `most` oscillators, whose steps are `steps` of the table's, dt_s long. */
export function coarseModel(
  modal: ModalTensors,
  modes: number,
  dt_s: number,
  most: number,
  steps: number,
): KernelModel {
  const all = modal.step.length / 6;
  const d = Math.min(most, all);
  const coupled = coupledOf(modal.limits.length);
  const c = Math.min(coupled, Math.max(0, d - SWAY_ROWS));
  const further = modes - all;
  const shown = Math.min(1, further);
  const coarse: ModalTensors = {
    ...modal,
    step: composed(modal.step, d, steps),
    load: modal.load.subarray(0, 2 * d),
    sway: leading(modal.sway, all, d),
    force: leading(modal.force, all, d, forceRows(coupled, c)),
    shown: modal.shown.subarray(0, d),
    pose: leading(modal.pose, further, shown, [...range(0, d), ...range(all, poseTerms(0, c))]),
    limits: Float32Array.from([
      ...modal.limits.subarray(0, 3 + c),
      ...modal.limits.subarray(3 + coupled, 3 + coupled + c),
    ]),
    ...mergedDrag(modal, all, d),
    dragPlace: new Float32Array(0),
    place: new Float32Array(0),
    placeLoad: new Float32Array(0),
  };
  return { modal: coarse, modes: d + shown, dt_s: steps * dt_s };
}
