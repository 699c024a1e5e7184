/**
 * Encoder and decoder of FRAME, the message that carries poses.
 *
 * Poses are quantized in units of `quantum` × the table's modes.scale. A key frame is int32. Any other frame holds the
 * differences to an earlier tick: int16 for the first `wide` modes, which move most, and int8 for the rest.
 */
import { WIRE_FRAME } from "../constants";
import { encodeMessage, entries, type Header, number, only, textMap, WireError, whole } from "./envelope";

/** Poses of one group, or their differences: `count` rows of `modes` numbers in units of `quantum` × modes.scale. */
interface Rows {
  count: number;
  modes: number;
  quantum: number;
  values: Int32Array<ArrayBuffer> | Int16Array<ArrayBuffer>;
}

/** Poses of every tree at one tick: absolute if `base` is null, otherwise differences to tick `base`. */
export interface Frame {
  type: "frame";
  tick: number;
  base: number | null;
  /** The forest's time. */
  time_s: number;
  /** Time on the server's clock, as in PONG. */
  made_s: number;
  groups: Rows[];
}

interface Shape {
  count: number;
  modes: number;
  quantum: number;
  wide: number;
}

/** The number of leading modes that need int16, so that the others fit int8. */
function wideModes({ modes, values }: Rows): number {
  let wide = 0;
  for (let i = 0; i < values.length; i++) {
    if (values[i] < -32768 || values[i] > 32767) throw new RangeError("a difference does not fit 16 bits");
    if (values[i] < -128 || values[i] > 127) wide = Math.max(wide, (i % modes) + 1);
  }
  return wide;
}

/** Encodes a frame; throws RangeError if a difference does not fit 16 bits. */
export function encodeFrame(frame: Frame): Uint8Array<ArrayBuffer> {
  const { tick, base, time_s, made_s } = frame;
  const shapes = frame.groups.map((rows): Shape => {
    const { count, modes, quantum } = rows;
    return { count, modes, quantum, wide: base === null ? modes : wideModes(rows) };
  });
  const payload = new Uint8Array(payloadLength(shapes, base === null));
  const view = new DataView(payload.buffer);
  if (base === null) writeKey(frame.groups, view);
  else writeDifferences(frame.groups, shapes, view);
  return encodeMessage(WIRE_FRAME, { tick, base, time_s, made_s, groups: shapes }, payload);
}

function writeKey(groups: readonly Rows[], view: DataView): void {
  let at = 0;
  for (const { values } of groups) {
    for (const value of values) {
      view.setInt32(at, value, true);
      at += 4;
    }
  }
}

function writeDifferences(groups: readonly Rows[], shapes: readonly Shape[], view: DataView): void {
  let at = 0;
  let narrow = wideBytes(shapes);
  for (const [g, { values, modes }] of groups.entries()) {
    for (let i = 0; i < values.length; i++) {
      if (i % modes < shapes[g].wide) {
        view.setInt16(at, values[i], true);
        at += 2;
      } else view.setInt8(narrow++, values[i]);
    }
  }
}

const wideBytes = (shapes: readonly Shape[]) =>
  shapes.reduce((sum, { count, wide }) => sum + 2 * count * wide, 0);

function payloadLength(shapes: readonly Shape[], key: boolean): number {
  if (key) return shapes.reduce((sum, { count, modes }) => sum + 4 * count * modes, 0);
  return wideBytes(shapes) + shapes.reduce((sum, { count, modes, wide }) => sum + count * (modes - wide), 0);
}

/** Inverse of encodeFrame. Throws WireError. */
export function decodeFrame(header: Header, payload: Uint8Array<ArrayBuffer>): Frame {
  only(header, "tick", "base", "time_s", "made_s", "groups");
  const base = header.base === null ? null : whole(header, "base");
  const shapes = entries(header, "groups").map(decodeShape);
  if (payload.length !== payloadLength(shapes, base === null)) {
    throw new WireError("the length of the payload does not match the groups");
  }
  return {
    type: "frame",
    tick: whole(header, "tick"),
    base,
    time_s: number(header, "time_s"),
    made_s: number(header, "made_s"),
    groups: base === null ? readKey(shapes, payload) : readDifferences(shapes, payload),
  };
}

/** Views into the message. */
function readKey(shapes: readonly Shape[], { buffer, byteOffset }: Uint8Array<ArrayBuffer>): Rows[] {
  let at = byteOffset;
  return shapes.map(({ count, modes, quantum }) => {
    const values = new Int32Array(buffer, at, count * modes);
    at += values.byteLength;
    return { count, modes, quantum, values };
  });
}

function readDifferences(shapes: readonly Shape[], { buffer, byteOffset }: Uint8Array<ArrayBuffer>): Rows[] {
  let at = byteOffset;
  let narrowAt = byteOffset + wideBytes(shapes);
  return shapes.map(({ count, modes, quantum, wide }) => {
    const near = new Int16Array(buffer, at, count * wide);
    const far = new Int8Array(buffer, narrowAt, count * (modes - wide));
    at += near.byteLength;
    narrowAt += far.byteLength;
    return { count, modes, quantum, values: interleave(near, far, count, wide, modes - wide) };
  });
}

function interleave(near: Int16Array, far: Int8Array, count: number, wide: number, narrow: number) {
  const values = new Int16Array(count * (wide + narrow));
  for (let row = 0, i = 0, n = 0, f = 0; row < count; row++) {
    for (let k = 0; k < wide; k++) values[i++] = near[n++];
    for (let k = 0; k < narrow; k++) values[i++] = far[f++];
  }
  return values;
}

function decodeShape(entry: unknown): Shape {
  const group = textMap(entry, "a group");
  only(group, "count", "modes", "quantum", "wide");
  const shape = {
    count: whole(group, "count"),
    modes: whole(group, "modes"),
    quantum: whole(group, "quantum"),
    wide: whole(group, "wide"),
  };
  if (shape.wide > shape.modes || shape.quantum < 1) {
    throw new WireError("quantum must be at least 1, and wide at most the number of modes");
  }
  return shape;
}
