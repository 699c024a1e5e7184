/**
 * Reader of the table format: one safetensors file per species (docs/formats/table.md). Same as
 * precompute/galewood/table/.
 */
import { type Container, need } from "./container";
import { assemble, checkMetadata, openTable, readPresent, type Table, VERSION } from "./present";
import { readRecords } from "./records";
import { fromVersion5 } from "./version5";
import { fromVersion6, peakPressure_pa, reach_m } from "./version6";

export { TableError } from "./container";
export {
  FORMAT,
  type Foliage,
  fittedModes,
  type Primitive,
  type Table,
  type TableMetadata,
  VERSION,
} from "./present";

/** The oldest version that can be read. */
const OLDEST = 5;

/** Decodes a table file. Throws TableError that names the fault. */
export function decodeTable(file: ArrayBuffer | Uint8Array): Table {
  const container = openTable(file, OLDEST);
  return Number(container.metadata.version) >= 7
    ? readPresent(container, readRecords)
    : readFormer(container);
}

/** Versions 5 and 6, whose reach and peak pressure follow from their records. */
function readFormer(container: Container): Table {
  const former = container.metadata.version === 5 ? fromVersion5(container) : container;
  const trajectories = shapeInHeader(former.header["samples.trajectory"]) - 1;
  const { paper, ...metadata } = fromVersion6(former.metadata, VERSION, Math.max(0, trajectories));
  // Replaced below, because they follow from the decoded records.
  const table = assemble(former, { ...metadata, peak_pressure_pa: 0, reach_m: 0 }, paper, readRecords);
  need(table.paper !== null && table.nodeRest.length > 0, "damaged table file: no nodes");
  const derived = {
    peak_pressure_pa: peakPressure_pa(table.paper),
    reach_m: reach_m(table.paper, table.nodeBasis, table.modeScale),
  };
  return { ...table, metadata: checkMetadata({ ...table.metadata, ...derived }) };
}

/** First side of a tensor's shape, unchecked; 0 without one. */
function shapeInHeader(entry: unknown): number {
  const shape = (entry as { shape?: unknown } | null | undefined)?.shape;
  return Array.isArray(shape) && Number.isSafeInteger(shape[0]) ? shape[0] : 0;
}
