/** Extracts the part of a table that drawing needs. Pure. */

import { poseStride } from "../../core/motion/poseStride";
import type { Table } from "../../core/table/table";
import type { TableMotion } from "../protocol";
import { firstSwayOf } from "./firstSway";
import { coarserNodes } from "./nodeLevels";
import { oscillatorFrequencies_hz } from "./oscillators";

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

/** What a preliminary table leaves out, in words. */
function leftOutOf({ metadata }: Table): string[] {
  const { left_out } = (metadata.provenance ?? {}) as { left_out?: unknown };
  return Array.isArray(left_out) ? left_out.filter((word) => typeof word === "string").slice(0, 12) : [];
}

const isPreliminary = ({ metadata }: Table) =>
  (metadata.provenance as { preliminary?: unknown } | undefined)?.preliminary === true;

/** Figures of what is drawn, by name. */
function drawnOf({ metadata }: Table): Record<string, number> {
  const given = Object.entries((metadata.drawn ?? {}) as object);
  return Object.fromEntries(given.filter((entry) => Number.isFinite(entry[1])).slice(0, 24));
}

export function tableMotion(sha256: string, table: Table, bytes: number): TableMotion {
  const { modes, primitives, height_m, mesh_sha256, foliage = "leaf", reach_m } = table.metadata;
  const stride = poseStride(modes);
  const basis = padBasis(table.nodeBasis, modes, stride);
  const turn = padBasis(table.nodeTurn, modes, stride);
  const rest_m = Float32Array.from(table.nodeRest);
  const parent = Uint16Array.from(table.nodeParent);
  const nodes = table.nodeRest.length / 3;
  const all = Uint16Array.from({ length: modes }, (_, k) => k);
  const of = Uint16Array.from({ length: nodes }, (_, node) => node);
  return {
    sha256,
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
    levels: [
      { nodes, quads: stride / 4, columns: all, of, basis, turn, rest_m, parent },
      ...coarserNodes(table),
    ],
    reach_m,
    vertexNode: Uint16Array.from(table.vertexNode),
    primitives: primitives.map(({ name, kind, vertices }) => ({ name, kind, vertices })),
    crownBasis: crownBasisOf(table),
    sway: firstSwayOf(table, stride, basis),
    frequencies_hz: oscillatorFrequencies_hz(table.modal.step, table.metadata.dt_s),
    height_m,
    meshSha256: mesh_sha256,
    foliage,
    hasRecords: table.paper !== null,
    preliminary: isPreliminary(table),
    linear: table.modal.pose.length === 0,
    leftOut: leftOutOf(table),
    drawn: drawnOf(table),
    bytes,
  };
}

/** The buffers to transfer instead of copying. */
export function motionBuffers(motion: TableMotion): ArrayBuffer[] {
  const { basis, turn, rest_m, parent, vertexNode, crownBasis, levels } = motion;
  const { jointNodes, jointShare, jointRest_m, vertexJoint } = motion;
  const own = [
    basis,
    turn,
    rest_m,
    parent,
    jointNodes,
    jointShare,
    jointRest_m,
    vertexJoint,
    vertexNode,
    crownBasis,
    ...levels.flatMap((level) => [
      level.of,
      level.columns,
      level.basis,
      level.turn,
      level.rest_m,
      level.parent,
    ]),
  ];
  return [...new Set(own.map(({ buffer }) => buffer))];
}
