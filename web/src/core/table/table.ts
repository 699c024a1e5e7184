/**
 * Reader of the table format: one safetensors file per species (docs/formats/table.md). Same as
 * precompute/galewood/table/. Everything is validated here, so that a decoded table can be used without bounds checks.
 */

import { contracts, coupledOf, forceTerms, type ModalTensors, poseTerms } from "../modal/modalTensors";
import { fromVersion5 } from "./version5";

export const FORMAT = "galewood-table";
export const VERSION = 6;
const MAX_HEADER_BYTES = 1 << 20;
const MAX_DYNAMIC = 64;

export class TableError extends Error {
  override readonly name = "TableError";
}

export interface Primitive {
  readonly name: string;
  readonly kind: string;
  readonly vertices: number;
}

export interface TableMetadata {
  readonly species: string;
  readonly height_m: number;
  readonly dt_s: number;
  readonly modes: number;
  readonly records: number;
  readonly primitives: readonly Primitive[];
  readonly sampled_elements: number;
  readonly points: number;
  readonly components: number;
  readonly sigma_pa: number;
  readonly weight: { readonly initial: number; readonly maximum: number; readonly growth: number };
  readonly pose_easing: number;
  readonly design_speed_m_s: number;
  readonly mesh_sha256: string;
  readonly [more: string]: unknown;
}

/** A decoded table: r modes, z records, n nodes. Units in docs/formats/table.md. */
export interface Table {
  readonly metadata: TableMetadata;
  /** [r] metres of q per integer step */
  readonly modeScale: Float32Array;
  /** [n, 3, r] metres per unit of q */
  readonly nodeBasis: Float32Array;
  /** [n, 3] */
  readonly nodeRest: Float32Array;
  /** node of each render vertex, primitives concatenated */
  readonly vertexNode: Uint16Array;
  /** [z, r] in units of modeScale */
  readonly dq: Int16Array;
  /** [z, 2] Pa */
  readonly pressure: Float32Array;
  /** start of each trajectory, and z */
  readonly trajectory: Uint32Array;
  /** [z + 1] candidates of each state, CSR */
  readonly offsets: Uint32Array;
  readonly candidate: Uint16Array;
  readonly mismatches: Uint16Array;
  readonly modal: ModalTensors;
}

type Numbers = Float32Array | Int16Array | Uint16Array | Uint32Array;
const TYPES = { F32: Float32Array, I16: Int16Array, U16: Uint16Array, U32: Uint32Array } as const;
const TENSORS: Readonly<Record<string, readonly [keyof typeof TYPES, number]>> = {
  "modes.scale": ["F32", 1],
  "nodes.basis": ["F32", 3],
  "nodes.rest_m": ["F32", 2],
  "render.vertex_node": ["U16", 1],
  "samples.dq": ["I16", 2],
  "samples.pressure_pa": ["F32", 2],
  "samples.trajectory": ["U32", 1],
  "search.offsets": ["U32", 1],
  "search.record": ["U16", 1],
  "search.mismatch_steps": ["U16", 1],
  "modal.step": ["F32", 2],
  "modal.load": ["F32", 2],
  "modal.sway": ["F32", 2],
  "modal.force": ["F32", 2],
  "modal.shown": ["F32", 1],
  "modal.pose": ["F32", 2],
  "modal.limits": ["F32", 1],
};

interface Tensor {
  readonly shape: readonly number[];
  readonly values: Numbers;
}
type Json = Record<string, unknown>;

/** Decodes a table file. Throws TableError that names the fault. */
export function decodeTable(file: ArrayBuffer | Uint8Array): Table {
  // Plain bytes: slices of a Node Buffer would share its memory.
  const bytes =
    file instanceof Uint8Array
      ? new Uint8Array(file.buffer, file.byteOffset, file.byteLength)
      : new Uint8Array(file);
  const [given, body] = readHeader(bytes);
  const read = readMetadata(given);
  const { header, metadata } =
    read.version === 5 ? fromVersion5(given, read) : { header: given, metadata: read };
  const tensors = new Map<string, Tensor>();
  for (const name of Object.keys(TENSORS)) tensors.set(name, readTensor(header, body, name));
  for (const name of Object.keys(header)) {
    if (name !== "__metadata__" && !(name in TENSORS)) throw new TableError(`unknown tensor ${name}`);
  }
  checkShapes(tensors, metadata);
  const values = (name: string) => tensors.get(name)?.values as never;
  const table: Table = {
    metadata,
    modeScale: values("modes.scale"),
    nodeBasis: values("nodes.basis"),
    nodeRest: values("nodes.rest_m"),
    vertexNode: values("render.vertex_node"),
    dq: values("samples.dq"),
    pressure: values("samples.pressure_pa"),
    trajectory: values("samples.trajectory"),
    offsets: values("search.offsets"),
    candidate: values("search.record"),
    mismatches: values("search.mismatch_steps"),
    modal: {
      step: values("modal.step"),
      load: values("modal.load"),
      sway: values("modal.sway"),
      force: values("modal.force"),
      shown: values("modal.shown"),
      pose: values("modal.pose"),
      limits: values("modal.limits"),
    },
  };
  checkNumbers(table);
  checkTrajectories(table);
  checkOffsets(table);
  sumSteps(table);
  checkSearch(table);
  checkModal(table.modal);
  return table;
}

/** [z, r] pose of every record, in units of modeScale; every trajectory starts at 0. */
export function poses(table: Table): Int32Array {
  const { dq, trajectory } = table;
  const r = table.metadata.modes;
  const out = new Int32Array(dq.length);
  for (let t = 0; t + 1 < trajectory.length; t++) {
    for (let i = trajectory[t] + 1; i < trajectory[t + 1]; i++) {
      for (let k = 0; k < r; k++) out[i * r + k] = out[(i - 1) * r + k] + dq[(i - 1) * r + k];
    }
  }
  return out;
}

/** [z] 1 for the last record of each trajectory, which has no successor and is never chosen. */
export function lastRecords(trajectory: Uint32Array): Uint8Array {
  const last = new Uint8Array(trajectory[trajectory.length - 1]);
  for (let t = 1; t < trajectory.length; t++) last[trajectory[t] - 1] = 1;
  return last;
}

function need(holds: boolean, complaint: string): asserts holds {
  if (!holds) throw new TableError(complaint);
}

function object(value: unknown, complaint: string): Json {
  need(typeof value === "object" && value !== null && !Array.isArray(value), complaint);
  return value as Json;
}

function parse(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    throw new TableError("not a Galewood table: the metadata is unreadable");
  }
}

function readHeader(bytes: Uint8Array): [Json, Uint8Array] {
  need(bytes.length >= 8, "truncated table file: the header is missing");
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const length = view.getUint32(0, true) + view.getUint32(4, true) * 2 ** 32;
  need(
    length <= MAX_HEADER_BYTES && 8 + length <= bytes.length,
    "truncated table file, or not a table: the header does not fit",
  );
  const text = new TextDecoder().decode(bytes.subarray(8, 8 + length));
  return [
    object(parse(text), "not a Galewood table: the header is not an object"),
    bytes.subarray(8 + length),
  ];
}

function readMetadata(header: Json): TableMetadata {
  const texts = object(header.__metadata__, "not a Galewood table: the metadata is missing");
  need(typeof texts.galewood === "string", "not a Galewood table: the metadata is missing");
  const metadata = object(parse(texts.galewood), "not a Galewood table: the metadata is not an object");
  need(metadata.format === FORMAT, `not a ${FORMAT}: format ${String(metadata.format).slice(0, 40)}`);
  const version = String(metadata.version).slice(0, 40);
  const known = metadata.version === VERSION || metadata.version === 5;
  need(known, `table version ${version}; this reader supports versions 5 and ${VERSION}`);
  number(metadata, "height_m", 0.01, 1000);
  number(metadata, "dt_s", 1e-4, 1);
  number(metadata, "sigma_pa", 1e-9, 1e9);
  number(metadata, "pose_easing", 0, 1);
  number(metadata, "design_speed_m_s", 0, 100);
  whole(metadata, "modes", 256);
  for (const name of ["records", "points", "components"]) whole(metadata, name, 65535);
  const weight = object(metadata.weight, "metadata weight: expected an object");
  number(weight, "maximum", number(weight, "initial", 0, 0.999), 0.999);
  number(weight, "growth", 0, 1);
  need(Array.isArray(metadata.primitives), "metadata primitives: expected a list");
  for (const primitive of metadata.primitives) {
    number(object(primitive, "metadata primitives: expected objects"), "vertices", 0, 2 ** 31);
  }
  return metadata as TableMetadata;
}

function number(from: Json, name: string, low: number, high: number): number {
  const value = from[name];
  const real = typeof value === "number" && value >= low && value <= high;
  need(real, `metadata ${name}: expected a number in ${low}..${high}, not ${String(value).slice(0, 40)}`);
  return value as number;
}

function whole(from: Json, name: string, high: number): void {
  need(Number.isInteger(number(from, name, 1, high)), `metadata ${name}: expected a whole number`);
}

function readTensor(header: Json, body: Uint8Array, name: string): Tensor {
  need(name in header, `missing tensor ${name}`);
  const [dtype, rank] = TENSORS[name];
  const entry = object(header[name], `tensor ${name}: the description is missing`);
  const shape = entry.shape;
  const fits = entry.dtype === dtype && naturals(shape) && shape.length === rank;
  need(fits, `tensor ${name}: expected ${dtype} of rank ${rank}`);
  const range = entry.data_offsets;
  need(naturals(range) && range.length === 2, `tensor ${name}: the data offsets are missing`);
  const [start, end] = range;
  const type = TYPES[dtype];
  const count = shape.reduce((product, side) => product * side, 1);
  need(end <= body.length, `tensor ${name}: truncated`);
  need(
    end - start === count * type.BYTES_PER_ELEMENT,
    `tensor ${name}: ${end - start} bytes do not fit its shape`,
  );
  // Copied, because the file does not guarantee alignment, and so that it can be freed.
  return { shape, values: new type(body.slice(start, end).buffer) };
}

function naturals(value: unknown): value is number[] {
  return Array.isArray(value) && value.every((n) => Number.isSafeInteger(n) && n >= 0);
}

function checkShapes(tensors: ReadonlyMap<string, Tensor>, metadata: TableMetadata): void {
  const { modes: r, records: z } = metadata;
  const shapeOf = (name: string) => tensors.get(name)?.shape ?? [];
  const n = shapeOf("nodes.rest_m")[0];
  const vertices = metadata.primitives.reduce((sum, primitive) => sum + primitive.vertices, 0);
  const d = shapeOf("modal.step")[0];
  const most = Math.min(MAX_DYNAMIC, r);
  need(d >= 2 && d <= most, `tensor modal.step: expected 2..${most} rows`);
  const c = coupledOf(shapeOf("modal.limits")[0] ?? 0);
  need(
    Number.isInteger(c) && c >= 0 && c <= d - 2,
    `tensor modal.limits: expected 3, 5, … ${2 * d - 1} numbers`,
  );
  const expected: Record<string, number[]> = {
    "modes.scale": [r],
    "nodes.basis": [n, 3, r],
    "nodes.rest_m": [n, 3],
    "render.vertex_node": [vertices],
    "samples.dq": [z, r],
    "samples.pressure_pa": [z, 2],
    "search.offsets": [z + 1],
    "search.mismatch_steps": [...shapeOf("search.record")],
    "modal.step": [d, 6],
    "modal.load": [d, 2],
    "modal.sway": [2, d],
    "modal.force": [forceTerms(c), d],
    "modal.shown": [d],
    "modal.pose": [poseTerms(d, c), r - d],
    "modal.limits": [3 + 2 * c],
  };
  for (const [name, shape] of Object.entries(expected)) {
    const found = shapeOf(name);
    need(found.join() === shape.join(), `tensor ${name}: shape [${found}], expected [${shape}]`);
  }
}

function checkNumbers(table: Table): void {
  const floats = {
    "modes.scale": table.modeScale,
    "nodes.basis": table.nodeBasis,
    "nodes.rest_m": table.nodeRest,
  };
  for (const [name, values] of Object.entries({ ...floats, "samples.pressure_pa": table.pressure })) {
    need(values.every(Number.isFinite), `tensor ${name}: not finite`);
  }
  need(
    table.modeScale.every((s) => s > 0),
    "tensor modes.scale: not positive",
  );
  const nodes = table.nodeRest.length / 3;
  need(
    table.vertexNode.every((node) => node < nodes),
    "tensor render.vertex_node: node out of range",
  );
}

function checkModal(modal: ModalTensors): void {
  for (const [name, values] of Object.entries(modal) as [string, Float32Array][]) {
    need(values.every(Number.isFinite), `tensor modal.${name}: not finite`);
  }
  need(
    modal.limits.every((limit) => limit > 0),
    "tensor modal.limits: not positive",
  );
  need(contracts(modal.step), "tensor modal.step: an oscillator is not stable");
}

function checkTrajectories(table: Table): void {
  const { trajectory, metadata } = table;
  const ends = trajectory.length >= 2 && trajectory[0] === 0 && trajectory.at(-1) === metadata.records;
  need(ends, "tensor samples.trajectory: must run from 0 to the number of records");
  for (let t = 1; t < trajectory.length; t++) {
    // A trajectory of one record could never be chosen: its only record has no successor.
    need(
      trajectory[t] - trajectory[t - 1] >= 2 && trajectory[t] <= metadata.records,
      "tensor samples.trajectory: every trajectory needs two records",
    );
  }
}

function checkOffsets({ offsets, candidate, metadata: { records: z } }: Table): void {
  need(
    offsets[0] === 0 && offsets[z] === candidate.length,
    "tensor search.offsets: must run from 0 to the end",
  );
  for (let c = 0; c < z; c++) {
    need(offsets[c + 1] > offsets[c], "tensor search.offsets: every record needs a candidate");
    need(offsets[c + 1] <= candidate.length, "tensor search.offsets: must run from 0 to the end");
  }
}

/** Decodes the mismatches, which are delta-coded along each row of candidates. */
function sumSteps({ offsets, mismatches }: Table): void {
  for (let c = 0; c + 1 < offsets.length; c++) {
    for (let s = offsets[c] + 1; s < offsets[c + 1]; s++) {
      const sum = mismatches[s - 1] + mismatches[s];
      need(sum <= 65535, "tensor search.mismatch_steps: out of range");
      mismatches[s] = sum;
    }
  }
}

function checkSearch(table: Table): void {
  const { offsets, candidate, mismatches, metadata } = table;
  const z = metadata.records;
  const last = lastRecords(table.trajectory);
  for (let c = 0; c < z; c++) {
    let before = -1;
    for (let s = offsets[c]; s < offsets[c + 1]; s++) {
      const key = mismatches[s] * 65536 + candidate[s];
      need(key > before, "tensor search.record: candidates out of order");
      need(
        candidate[s] < z && last[candidate[s]] === 0,
        "tensor search.record: out of range, or the last of its trajectory",
      );
      need(mismatches[s] <= metadata.components, "tensor search.mismatch_steps: out of range");
      before = key;
    }
  }
}
