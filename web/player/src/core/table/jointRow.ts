/** Rows of joints, from those of the two nodes between which they lie. Pure. */
import type { Table } from "./table";

/** Writes the displacement [3, r] of a joint per unit of each coordinate. */
export function jointRow(
  { nodeBasis, jointNodes, jointShare, metadata: { modes } }: Table,
  joint: number,
  out: Float64Array,
): Float64Array {
  const [a, b] = [3 * modes * jointNodes[2 * joint], 3 * modes * jointNodes[2 * joint + 1]];
  const share = jointShare[joint];
  for (let i = 0; i < 3 * modes; i++) out[i] = (1 - share) * nodeBasis[a + i] + share * nodeBasis[b + i];
  return out;
}
