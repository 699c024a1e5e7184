/**
 * Few sums of terms by which a model's force can be computed. The force of an individual acts on its sway alone: all its terms
 * move the oscillators in two ways.
 */
import { MOST_TERM_SUMS, TERM_SUM_ROUNDING } from "../constants";

/** The force [F, d] as a product of `shares`, transposed, and `rows`. */
export interface TermSums {
  readonly count: number;
  /** [count, F] */
  readonly shares: Float32Array;
  /** [count, d] */
  readonly rows: Float32Array;
}

/** Where a number of `values` is largest. */
const largest = (values: Float64Array) =>
  values.reduce((best, value, at) => (Math.abs(value) > Math.abs(values[best]) ? at : best), 0);

/** The sums that give a force [F, d] to rounding; null if it takes more than MOST_TERM_SUMS. */
export function sumsOf(force: Float32Array, d: number): TermSums | null {
  const rows: number[] = [];
  const shares: number[] = [];
  const left = Float64Array.from(force);
  // Terms have units of their own, so each is compared with itself.
  const scale = Float64Array.from({ length: force.length / d }, (_, row) => {
    const own = left.subarray(row * d, (row + 1) * d);
    const most = Math.abs(own[largest(own)]) || 1;
    for (let k = 0; k < d; k++) own[k] /= most;
    return most;
  });
  for (let count = 0; count <= MOST_TERM_SUMS; count++) {
    const at = largest(left);
    const most = left[at];
    if (Math.abs(most) <= TERM_SUM_ROUNDING)
      return { count, shares: Float32Array.from(shares), rows: Float32Array.from(rows) };
    const pivot = left.slice(at - (at % d), at - (at % d) + d);
    rows.push(...pivot);
    scale.forEach((unit, row) => {
      const share = left[row * d + (at % d)] / most;
      shares.push(unit * share);
      for (let k = 0; k < d; k++) left[row * d + k] -= share * pivot[k];
    });
  }
  return null;
}
