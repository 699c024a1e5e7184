/** Extracts the part of a table that drawing needs. Pure. */

import { poseStride } from "../../core/motion/poseStride";
import { poses, type Table } from "../../core/table/table";
import type { TableMotion } from "../protocol";
import { coarserNodes } from "./nodeLevels";

/** The crown is the part above this share of the height. */
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
export function crownBasisOf(table: Table): Float32Array<ArrayBuffer> {
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

/** Margin for motion beyond the sampled range. */
const BEYOND = 1.25;
const TIPS = 8;

/** The nodes that move most in the first two modes: tips of the longest shoots. */
function tips(table: Table): number[] {
  const { modes } = table.metadata;
  const nodes = Array.from({ length: table.nodeRest.length / 3 }, (_, node) => node);
  const far = nodes.map((node) => {
    const rows = [0, 1, 2].map((axis) => (node * 3 + axis) * modes);
    return rows.reduce(
      (sum, row) => sum + table.nodeBasis[row] ** 2 + (table.nodeBasis[row + 1] || 0) ** 2,
      0,
    );
  });
  return nodes.sort((a, b) => far[b] - far[a]).slice(0, TIPS);
}

/** Largest displacement (m) of any part of the tree over the poses of all records. */
export function reach_m(table: Table): number {
  const { modes, records } = table.metadata;
  const { modeScale, nodeBasis } = table;
  const pose = poses(table);
  let most = 0;
  for (const tip of tips(table)) {
    for (let record = 0; record < records; record++) {
      let square = 0;
      for (let axis = 0; axis < 3; axis++) {
        let moved = 0;
        const row = (tip * 3 + axis) * modes;
        for (let k = 0; k < modes; k++) moved += nodeBasis[row + k] * modeScale[k] * pose[record * modes + k];
        square += moved * moved;
      }
      most = Math.max(most, square);
    }
  }
  return BEYOND * Math.sqrt(most);
}

export function tableMotion(sha256: string, table: Table, bytes: number): TableMotion {
  const { modes, primitives, height_m, mesh_sha256, pose_easing, records } = table.metadata;
  const stride = poseStride(modes);
  const basis = padBasis(table.nodeBasis, modes, stride);
  const nodes = table.nodeRest.length / 3;
  const of = Uint16Array.from({ length: nodes }, (_, node) => node);
  return {
    sha256,
    modes,
    stride,
    nodes,
    basis,
    rest_m: Float32Array.from(table.nodeRest),
    levels: [{ nodes, quads: stride / 4, modes, of, basis }, ...coarserNodes(table)],
    reach_m: reach_m(table),
    vertexNode: Uint16Array.from(table.vertexNode),
    primitives: primitives.map(({ name, kind, vertices }) => ({ name, kind, vertices })),
    crownBasis: crownBasisOf(table),
    height_m,
    meshSha256: mesh_sha256,
    poseEasing: pose_easing,
    records,
    bytes,
  };
}

/** The buffers to transfer instead of copying. */
export function motionBuffers(motion: TableMotion): ArrayBuffer[] {
  const { basis, rest_m, vertexNode, crownBasis, levels } = motion;
  const own = [basis, rest_m, vertexNode, crownBasis, ...levels.flatMap(({ of, basis: rows }) => [of, rows])];
  return [...new Set(own.map(({ buffer }) => buffer))];
}
