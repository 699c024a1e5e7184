/** The error of a table at each node, from a comparison with the reference solution. Pure. */
import type { TableMotion } from "galewood/client";
import type { Tracks } from "../compare/tracks";

/** Root mean square over all frames of the distance of each node from the reference, m. */
export function localError_m(
  { basis, stride, nodes }: TableMotion,
  { q, modes, frames }: Tracks,
): Float32Array {
  const error = new Float32Array(nodes);
  const off = new Float32Array(modes);
  for (let frame = 0; frame < frames; frame++) {
    for (let k = 0; k < modes; k++) off[k] = q.modal[frame * modes + k] - q.fem[frame * modes + k];
    for (let row = 0; row < 3 * nodes; row++) {
      let sum = 0;
      for (let k = 0; k < modes; k++) sum += basis[row * stride + k] * off[k];
      error[Math.floor(row / 3)] += sum * sum;
    }
  }
  return error.map((sum) => Math.sqrt(sum / Math.max(1, frames)));
}
