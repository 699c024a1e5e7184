/** Extracts what the page needs of a table. Pure. */

import { drawnBuffers, drawnMotion } from "../../core/table/drawnMotion";
import type { Table } from "../../core/table/table";
import type { TableMotion } from "../protocol";
import { firstSwayOf } from "./firstSway";
import { oscillatorFrequencies_hz } from "./oscillators";

/** The crown is the part above this share of the height. */
const CROWN_FROM = 0.6;

/** Mean displacement of the crown per unit of each coordinate: [3, modes]. */
function crownBasisOf(table: Table): Float32Array<ArrayBuffer> {
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
  const { primitives, mesh_sha256, foliage = "leaf" } = table.metadata;
  const drawn = drawnMotion(table);
  return {
    ...drawn,
    sha256,
    vertexNode: Uint16Array.from(table.vertexNode),
    primitives: primitives.map(({ name, kind, vertices }) => ({ name, kind, vertices })),
    crownBasis: crownBasisOf(table),
    sway: firstSwayOf(table, drawn.stride, drawn.basis),
    frequencies_hz: oscillatorFrequencies_hz(table.modal.step, table.metadata.dt_s),
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
export const motionBuffers = (motion: TableMotion): ArrayBuffer[] => [
  ...drawnBuffers(motion),
  motion.vertexNode.buffer,
  motion.crownBasis.buffer,
];
