/** Solves with the factor of a tree's stiffness. */
import { BINDING_CORNERS, WHOLE_WEIGHT } from "../constants";
import type { Compliance } from "./compliance";

/** Forward and backward substitution in place: forces [n, 3] in N become displacements in m. */
export function solveFactor({ free, pointer, rows, blocks: v }: Compliance, b: Float64Array): void {
  for (let k = 0; k < free; k++) {
    const p = 9 * pointer[k];
    const at = 3 * k;
    const y0 = v[p] * b[at];
    const y1 = v[p + 1] * b[at] + v[p + 2] * b[at + 1];
    const y2 = v[p + 3] * b[at] + v[p + 4] * b[at + 1] + v[p + 5] * b[at + 2];
    b[at] = y0;
    b[at + 1] = y1;
    b[at + 2] = y2;
    for (let q = pointer[k] + 1; q < pointer[k + 1]; q++) {
      const i = 3 * rows[q];
      const o = 9 * q;
      b[i] -= v[o] * y0 + v[o + 1] * y1 + v[o + 2] * y2;
      b[i + 1] -= v[o + 3] * y0 + v[o + 4] * y1 + v[o + 5] * y2;
      b[i + 2] -= v[o + 6] * y0 + v[o + 7] * y1 + v[o + 8] * y2;
    }
  }
  for (let k = free - 1; k >= 0; k--) {
    const p = 9 * pointer[k];
    const at = 3 * k;
    let y0 = b[at];
    let y1 = b[at + 1];
    let y2 = b[at + 2];
    for (let q = pointer[k] + 1; q < pointer[k + 1]; q++) {
      const i = 3 * rows[q];
      const o = 9 * q;
      y0 -= v[o] * b[i] + v[o + 3] * b[i + 1] + v[o + 6] * b[i + 2];
      y1 -= v[o + 1] * b[i] + v[o + 4] * b[i + 1] + v[o + 7] * b[i + 2];
      y2 -= v[o + 2] * b[i] + v[o + 5] * b[i + 1] + v[o + 8] * b[i + 2];
    }
    b[at] = v[p] * y0 + v[p + 1] * y1 + v[p + 3] * y2;
    b[at + 1] = v[p + 2] * y1 + v[p + 4] * y2;
    b[at + 2] = v[p + 5] * y2;
  }
}

/** [3, n, 3]: displacement of the nodes under unit forces along x, y and z on a vertex. */
export function unitResponses(of: Compliance, vertex: number): Float64Array[] {
  const row = of.vertexRow[vertex] * BINDING_CORNERS;
  return [0, 1, 2].map((axis) => {
    const b = new Float64Array(3 * of.free);
    for (let k = row; k < row + BINDING_CORNERS; k++) {
      if (of.node[k] < of.free) b[3 * of.node[k] + axis] += of.weight[k] / WHOLE_WEIGHT;
    }
    solveFactor(of, b);
    return b;
  });
}

/** Displacement of a row of the binding along one axis when the nodes move by u [n, 3]. */
export function displacementOfRow(of: Compliance, u: Float64Array, row: number, axis: number): number {
  let sum = 0;
  for (let k = row * BINDING_CORNERS; k < (row + 1) * BINDING_CORNERS; k++) {
    if (of.node[k] < of.free) sum += (of.weight[k] / WHOLE_WEIGHT) * u[3 * of.node[k] + axis];
  }
  return sum;
}

/** [rows, 3, 3]: displacement of every row of the binding, a column per unit force. */
export function displacementOfRows(of: Compliance, units: readonly Float64Array[]): Float64Array {
  const { node, weight, free } = of;
  const out = new Float64Array((9 * node.length) / BINDING_CORNERS);
  for (let k = 0; k < node.length; k++) {
    if (node[k] >= free || weight[k] === 0) continue;
    const share = weight[k] / WHOLE_WEIGHT;
    const from = 3 * node[k];
    const to = 9 * Math.floor(k / BINDING_CORNERS);
    for (let j = 0; j < 3; j++) for (let i = 0; i < 3; i++) out[to + 3 * j + i] += share * units[j][from + i];
  }
  return out;
}
