/** Extracts the part of a table by which trees are drawn. Pure. */

import { poseStride } from "../motion/poseStride";
import { bendNodes, cardLevel } from "./cardLevel";
import type { DrawnMotion } from "./drawnTable";
import { coarserNodes } from "./nodeLevels";
import type { Table } from "./table";

/** The basis with rows padded to whole texels: [nodes, 3, stride]. */
function padBasis(basis: Float32Array, modes: number, stride: number): Float32Array<ArrayBuffer> {
  const rows = basis.length / modes;
  const padded = new Float32Array(rows * stride);
  for (let row = 0; row < rows; row++)
    padded.set(basis.subarray(row * modes, (row + 1) * modes), row * stride);
  return padded;
}

export function drawnMotion(table: Table): DrawnMotion {
  const { modes, height_m, reach_m } = table.metadata;
  const stride = poseStride(modes);
  const basis = padBasis(table.nodeBasis, modes, stride);
  const turn = padBasis(table.nodeTurn, modes, stride);
  const rest_m = Float32Array.from(table.nodeRest);
  const parent = Uint16Array.from(table.nodeParent);
  const nodes = table.nodeRest.length / 3;
  const of = Uint16Array.from({ length: nodes }, (_, node) => node);
  const coordinates = Uint16Array.from({ length: modes }, (_, k) => k);
  const { middle, tip } = bendNodes({ rest_m, height_m });
  const bend = [middle, tip] as const;
  const full = { nodes, quads: stride / 4, coordinates, of, basis, turn, rest_m, parent, bend };
  const coarser = coarserNodes(table, bend);
  return {
    modes,
    stride,
    nodes,
    basis,
    turn,
    rest_m,
    parent,
    jointNodes: Uint16Array.from(table.jointNodes),
    jointShare: Float32Array.from(table.jointShare),
    jointRest_m: Float32Array.from(table.jointRest),
    vertexJoint: Uint16Array.from(table.vertexJoint),
    levels: [full, ...coarser, cardLevel(coarser[coarser.length - 1])],
    reach_m,
    height_m,
  };
}

/** The buffers to transfer instead of copying. */
export function drawnBuffers(motion: DrawnMotion): ArrayBuffer[] {
  const { basis, turn, rest_m, parent, levels } = motion;
  const { jointNodes, jointShare, jointRest_m, vertexJoint } = motion;
  const own = [basis, turn, rest_m, parent, jointNodes, jointShare, jointRest_m, vertexJoint];
  const ofLevels = levels.flatMap((level) => [
    level.coordinates,
    level.of,
    level.basis,
    level.turn,
    level.rest_m,
    level.parent,
  ]);
  return [...new Set([...own, ...ofLevels].map(({ buffer }) => buffer))];
}
