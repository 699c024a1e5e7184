/**
 * The envelope of every wire message: prefix, msgpack map, padding, payload. Specified in spec/formats/wire.md.
 * The readers below validate the fields of a header.
 */
import { decode, encode } from "@msgpack/msgpack";
import { WIRE_MAGIC, WIRE_MAX_HEADER_BYTES, WIRE_PREFIX_BYTES, WIRE_VERSION } from "../constants";

const MAGIC = [...WIRE_MAGIC].map((letter) => letter.charCodeAt(0));

export type Header = Record<string, unknown>;

/** A malformed message, or one of another version. `code` is machine-readable. */
export class WireError extends Error {
  constructor(
    message: string,
    readonly code = "malformed-message",
  ) {
    super(message);
    this.name = "WireError";
  }
}

const padding = (length: number) => (8 - (length % 8)) % 8;

/** Assembles a message from its parts. */
export function encodeMessage(
  kind: number,
  header: Header,
  payload = new Uint8Array(0),
): Uint8Array<ArrayBuffer> {
  const packed = encode(header);
  const start = WIRE_PREFIX_BYTES + packed.length + padding(packed.length);
  const message = new Uint8Array(start + payload.length);
  message.set([...MAGIC, WIRE_VERSION, kind]);
  new DataView(message.buffer).setUint32(4, packed.length, true);
  message.set(packed, WIRE_PREFIX_BYTES);
  message.set(payload, start);
  return message;
}

export interface Message {
  kind: number;
  header: Header;
  /** A view into the message, aligned to 8 bytes. */
  payload: Uint8Array<ArrayBuffer>;
}

/** Splits a message into kind, header and payload. Throws WireError. */
export function decodeMessage(data: ArrayBuffer): Message {
  const bytes = new Uint8Array(data);
  if (bytes.length < WIRE_PREFIX_BYTES || bytes[0] !== MAGIC[0] || bytes[1] !== MAGIC[1]) {
    throw new WireError("not a Galewood message: it must begin with the bytes 'GW'");
  }
  if (bytes[2] !== WIRE_VERSION) {
    const words = `wire version ${bytes[2]}; this reader knows version ${WIRE_VERSION}`;
    throw new WireError(words, "unknown-version");
  }
  const length = new DataView(data).getUint32(4, true);
  const start = WIRE_PREFIX_BYTES + length + padding(length);
  if (length > WIRE_MAX_HEADER_BYTES || start > bytes.length) {
    throw new WireError("the header is longer than the message or the limit");
  }
  if (bytes.subarray(WIRE_PREFIX_BYTES + length, start).some((byte) => byte !== 0)) {
    throw new WireError("the padding after the header is not zero");
  }
  const header = unpack(bytes.subarray(WIRE_PREFIX_BYTES, WIRE_PREFIX_BYTES + length));
  return { kind: bytes[3], header, payload: bytes.subarray(start) };
}

function unpack(packed: Uint8Array): Header {
  let header: unknown;
  try {
    header = decode(packed);
  } catch {
    throw new WireError("the header is not msgpack");
  }
  return textMap(header, "the header");
}

/** Checks that a header has exactly these fields; the error names the first missing or unknown one. */
export function only(header: Header, ...names: string[]): void {
  const missing = names.filter((name) => !(name in header)).sort();
  if (missing.length) throw new WireError(`the field '${missing[0]}' is missing`);
  const unknown = Object.keys(header)
    .filter((name) => !names.includes(name))
    .sort();
  if (unknown.length) throw new WireError(`the field '${unknown[0].slice(0, 40)}' is unknown`);
}

export function text(header: Header, name: string): string {
  const value = header[name];
  if (typeof value !== "string") throw new WireError(`${name} must be text`);
  return value;
}

export function textMap(value: unknown, name: string): Header {
  if (typeof value !== "object" || value === null || Object.getPrototypeOf(value) !== Object.prototype) {
    throw new WireError(`${name} must be a map with text keys`);
  }
  return value as Header;
}

export function entries(header: Header, name: string): unknown[] {
  const value = header[name];
  if (!Array.isArray(value)) throw new WireError(`${name} must be a list`);
  return value;
}

/** A non-negative integer. */
export function whole(header: Header, name: string): number {
  const value = header[name];
  if (!Number.isSafeInteger(value) || (value as number) < 0) {
    throw new WireError(`${name} must be a non-negative integer`);
  }
  return value as number;
}

/** A finite number in a range. */
export function number(header: Header, name: string, low = -1e12, high = 1e12): number {
  const value = header[name];
  if (typeof value !== "number" || !Number.isFinite(value)) {
    throw new WireError(`${name} must be a finite number`);
  }
  if (value < low || value > high) throw new WireError(`${name} must lie in ${low}..${high}`);
  return value;
}

/** A boolean. */
export function truth(header: Header, name: string): boolean {
  const value = header[name];
  if (typeof value !== "boolean") throw new WireError(`${name} must be true or false`);
  return value;
}
