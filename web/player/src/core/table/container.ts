/** What tables and records files share: safetensors with one JSON object of metadata, read with full checks. */
import { MAX_TABLE_HEADER_BYTES } from "../constants";

export class TableError extends Error {
  override readonly name = "TableError";
}

export type Json = Record<string, unknown>;
type Numbers = Float32Array | Int16Array | Uint16Array | Uint32Array;
const TYPES = { F32: Float32Array, I16: Int16Array, U16: Uint16Array, U32: Uint32Array } as const;

/** Type and rank of each tensor by name. */
export type Layout = Readonly<Record<string, readonly [keyof typeof TYPES, number]>>;

interface Tensor {
  readonly shape: readonly number[];
  readonly values: Numbers;
}
export type Tensors = ReadonlyMap<string, Tensor>;

/** A file before its tensors are read: `header` describes them, `body` holds their bytes. */
export interface Container {
  readonly header: Json;
  readonly body: Uint8Array;
  readonly metadata: Json;
}

export function need(holds: boolean, complaint: string): asserts holds {
  if (!holds) throw new TableError(complaint);
}

export function object(value: unknown, complaint: string): Json {
  need(typeof value === "object" && value !== null && !Array.isArray(value), complaint);
  return value as Json;
}

export function number(from: Json, name: string, low: number, high: number): number {
  const value = from[name];
  const real = typeof value === "number" && value >= low && value <= high;
  need(real, `metadata ${name}: expected a number in ${low}..${high}, not ${String(value).slice(0, 40)}`);
  return value as number;
}

export function whole(from: Json, name: string, high: number): number {
  const value = number(from, name, 1, high);
  need(Number.isInteger(value), `metadata ${name}: expected a whole number`);
  return value;
}

/** The beginning of an unknown value, for a message. */
export const brief = (value: unknown) => String(value).slice(0, 40);

function parse(text: string | Uint8Array): unknown {
  try {
    return JSON.parse(
      typeof text === "string" ? text : new TextDecoder("utf-8", { fatal: true }).decode(text),
    );
  } catch {
    throw new TableError("not a Galewood table: the metadata is unreadable");
  }
}

/** Reads header and metadata of a file. Throws TableError. */
export function readContainer(file: ArrayBuffer | Uint8Array): Container {
  // Plain bytes: slices of a Node Buffer would share its memory.
  const bytes =
    file instanceof Uint8Array
      ? new Uint8Array(file.buffer, file.byteOffset, file.byteLength)
      : new Uint8Array(file);
  need(bytes.length >= 8, "truncated table file: the header is missing");
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const length = view.getUint32(0, true) + view.getUint32(4, true) * 2 ** 32;
  need(
    length <= MAX_TABLE_HEADER_BYTES && 8 + length <= bytes.length,
    "truncated table file, or not a table: the header does not fit",
  );
  const { __metadata__, ...header } = object(
    parse(bytes.subarray(8, 8 + length)),
    "not a Galewood table: the header is not an object",
  );
  const texts = object(__metadata__, "not a Galewood table: the metadata is missing");
  need(typeof texts.galewood === "string", "not a Galewood table: the metadata is missing");
  const metadata = object(parse(texts.galewood), "not a Galewood table: the metadata is not an object");
  return { header, body: bytes.subarray(8 + length), metadata };
}

/** Refuses a file of another format or version. */
export function checkFormat({ format, version }: Json, name: string, readable: number): void {
  need(format === name, `not a ${name}: format ${brief(format)}`);
  const kind = name.replace("galewood-", "");
  need(version === readable, `${kind} version ${brief(version)}; this reader knows version ${readable}`);
}

/** Refuses tensors that are in none of these layouts. */
export function refuseUnknown(header: Json, ...layouts: readonly Layout[]): void {
  for (const name of Object.keys(header)) {
    need(
      layouts.some((layout) => Object.hasOwn(layout, name)),
      `unknown tensor ${name.slice(0, 60)}`,
    );
  }
}

/** The tensors of a layout, of the expected type and rank. */
export function readTensors({ header, body }: Container, layout: Layout): Tensors {
  return new Map(
    Object.entries(layout).map(([name, [dtype, rank]]) => [
      name,
      readTensor(header, body, name, dtype, rank),
    ]),
  );
}

function readTensor(
  header: Json,
  body: Uint8Array,
  name: string,
  dtype: keyof typeof TYPES,
  rank: number,
): Tensor {
  need(Object.hasOwn(header, name), `missing tensor ${name}`);
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

/** Refuses a file whose tensors overlap or leave bytes unused. */
export function checkFilled({ header, body }: Container): void {
  const ranges = Object.values(header).map(
    (entry) => (entry as { data_offsets: [number, number] }).data_offsets,
  );
  ranges.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  let at = 0;
  for (const [start, end] of ranges) {
    need(start === at, "damaged table file: tensors overlap, or leave bytes unused");
    at = end;
  }
  need(at === body.length, "damaged table file: bytes after the last tensor");
}

export const shapeOf = (tensors: Tensors, name: string): readonly number[] => tensors.get(name)?.shape ?? [];

/** The numbers of a tensor; the layout determines their type. */
export const valuesOf = (tensors: Tensors, name: string) => tensors.get(name)?.values as never;

export function checkShapes(tensors: Tensors, expected: Readonly<Record<string, readonly number[]>>): void {
  for (const [name, shape] of Object.entries(expected)) {
    const found = shapeOf(tensors, name);
    need(found.join() === shape.join(), `tensor ${name}: shape [${found}], expected [${shape}]`);
  }
}

/** Refuses floating-point tensors that are not finite. */
export function checkFinite(tensors: Tensors): void {
  for (const [name, { values }] of tensors) {
    if (values instanceof Float32Array) need(values.every(Number.isFinite), `tensor ${name}: not finite`);
  }
}
