/** What the screen needs of a table. Pure. */
import { poseStride } from "../nodeLayout";
import type { Table } from "../table";
import type { TableMotion } from "./protocol";

/** The crown is what lies above this share of the height. */
const CROWN_FROM = 0.6;

/** The basis with rows padded to whole texels: [nodes, 3, stride]. */
function padBasis(basis: Float32Array, modes: number, stride: number): Float32Array<ArrayBuffer> {
  const rows = basis.length / modes;
  const padded = new Float32Array(rows * stride);
  for (let row = 0; row < rows; row++)
    padded.set(basis.subarray(row * modes, (row + 1) * modes), row * stride);
  return padded;
}

/** Mean displacement of the crown per unit of each coordinate: [3, modes]. */
export function crownBasis(table: Table): Float32Array<ArrayBuffer> {
  const { modes, height_m } = table.metadata;
  const mean = new Float32Array(3 * modes);
  let nodes = 0;
  for (let node = 0; node < table.nodeRest.length / 3; node++) {
    if (table.nodeRest[node * 3 + 1] < CROWN_FROM * height_m) continue;
    nodes++;
    for (let i = 0; i < mean.length; i++) mean[i] += table.nodeBasis[node * 3 * modes + i];
  }
  return mean.map((sum) => sum / Math.max(1, nodes));
}

export function tableMotion(sha256: string, table: Table, bytes: number): TableMotion {
  const { modes, primitives, height_m, mesh_sha256, pose_easing, records } = table.metadata;
  const stride = poseStride(modes);
  return {
    sha256,
    modes,
    stride,
    nodes: table.nodeRest.length / 3,
    basis: padBasis(table.nodeBasis, modes, stride),
    vertexNode: Uint16Array.from(table.vertexNode),
    primitives: primitives.map(({ name, kind, vertices }) => ({ name, kind, vertices })),
    crownBasis: crownBasis(table),
    height_m,
    meshSha256: mesh_sha256,
    poseEasing: pose_easing,
    records,
    bytes,
  };
}
