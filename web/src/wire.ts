/**
 * THE wire format of /ws/forest, version 1: specified in docs/formats/wire.md, twin of server/wire.py.
 *
 * Requests go from client to server, replies back; envelope.ts says what they have in common. encode… stands
 * beside decode…; what decodes has been checked, so that nobody downstream checks again.
 */
import {
  decodeMessage,
  encodeMessage,
  entries,
  type Header,
  number,
  only,
  text,
  textMap,
  WireError,
  whole,
} from "./envelope";

export { VERSION, WireError } from "./envelope";

const HELLO = 1;
const FOREST = 2;
const WIND = 3;
const PING = 4;
const WELCOME = 65;
const TABLE = 66;
const FRAME = 67;
const ERROR = 68;
const PONG = 69;
const WIND_STATE = 70;

// ---- client to server ----------------------------------------------------------------------------

/** First message of a client: a name for itself. */
export interface Hello {
  type: "hello";
  client: string;
}

/** `count` trees that share one table (SHA-256 in hex). */
export interface Group {
  table: string;
  count: number;
}

/** What the client wants: tables to look up itself, or a stream of poses of these trees. */
export interface Forest {
  type: "forest";
  mode: "stream" | "table";
  groups: Group[];
  wind: Header;
  time_s: number;
  /** null: each table's own. */
  pose_easing: number | null;
  /** How poses are made; "tangent" where it is not given. */
  method?: "tangent" | "paper";
  /** Four numbers a tree: x m, z m, yaw rad, scale; empty in mode "table". */
  trees: Float32Array<ArrayBuffer>;
}

/** A new wind document (docs/formats/wind.md). */
export interface WindChange {
  type: "wind";
  wind: Header;
}

/** Asks for a Pong with the same number. */
export interface Ping {
  type: "ping";
  t: number;
}

export type Request = Hello | Forest | WindChange | Ping;

/** The bytes of a client's message. */
export function encodeRequest(request: Request): Uint8Array<ArrayBuffer> {
  switch (request.type) {
    case "hello":
      return encodeMessage(HELLO, { client: request.client });
    case "wind":
      return encodeMessage(WIND, { wind: request.wind });
    case "ping":
      return encodeMessage(PING, { t: request.t });
    case "forest":
      return encodeForest(request);
  }
}

/** The message of a client. Throws WireError. */
export function decodeRequest(data: ArrayBuffer): Request {
  const { kind, header, payload } = decodeMessage(data);
  if (kind === FOREST) return decodeForest(header, payload);
  if (payload.length) throw new WireError("only a FOREST message has a payload");
  switch (kind) {
    case HELLO:
      only(header, "client");
      return { type: "hello", client: text(header, "client").slice(0, 200) };
    case WIND:
      only(header, "wind");
      return { type: "wind", wind: textMap(header.wind, "wind") };
    case PING:
      only(header, "t");
      return { type: "ping", t: number(header, "t") };
    default:
      throw new WireError(`kind ${kind} is not a message that clients send`, "unknown-kind");
  }
}

/** FOREST: groups in the header, a row of four float32 a tree in the payload. */
export function encodeForest(forest: Forest): Uint8Array<ArrayBuffer> {
  const header = {
    mode: forest.mode,
    groups: forest.groups.map(({ table, count }) => ({ table, count })),
    options: {
      ...(forest.pose_easing !== null && { pose_easing: forest.pose_easing }),
      ...(forest.method === "paper" && { method: forest.method }),
    },
    wind: forest.wind,
    time_s: forest.time_s,
  };
  const { buffer, byteOffset, byteLength } = forest.trees;
  return encodeMessage(FOREST, header, new Uint8Array(buffer, byteOffset, byteLength));
}

/** The twin of encodeForest. Throws WireError. */
export function decodeForest(header: Header, payload: Uint8Array<ArrayBuffer>): Forest {
  only(header, "mode", "groups", "options", "wind", "time_s");
  const mode = text(header, "mode");
  if (mode !== "stream" && mode !== "table") throw new WireError("mode must be 'stream' or 'table'");
  const options = textMap(header.options, "options");
  const eased = "pose_easing" in options;
  const named = "method" in options;
  only(options, ...(eased ? ["pose_easing"] : []), ...(named ? ["method"] : []));
  const method = named ? text(options, "method") : "tangent";
  if (method !== "tangent" && method !== "paper") throw new WireError("method must be 'tangent' or 'paper'");
  const groups = entries(header, "groups").map(decodeGroup);
  const count = mode === "stream" ? groups.reduce((sum, group) => sum + group.count, 0) : 0;
  return {
    type: "forest",
    mode,
    groups,
    wind: textMap(header.wind, "wind"),
    time_s: number(header, "time_s", -1e9, 1e9),
    pose_easing: eased ? number(options, "pose_easing", 0, 1) : null,
    ...(named && { method }),
    trees: decodeTrees(payload, count),
  };
}

function decodeGroup(entry: unknown): Group {
  const group = textMap(entry, "a group");
  only(group, "table", "count");
  const table = text(group, "table");
  if (!/^[0-9a-f]{64}$/.test(table)) throw new WireError("table must be a SHA-256 in hex");
  return { table, count: whole(group, "count") };
}

function decodeTrees(payload: Uint8Array<ArrayBuffer>, count: number): Float32Array<ArrayBuffer> {
  if (payload.length !== count * 16) {
    throw new WireError(`the payload has ${payload.length} bytes; ${count} trees need ${count * 16}`);
  }
  const trees = new Float32Array(payload.buffer, payload.byteOffset, count * 4);
  if (!trees.every((value) => Math.abs(value) <= 1e6)) {
    throw new WireError("a tree's place, yaw or scale is not a sensible number");
  }
  if (!trees.every((value, index) => index % 4 !== 3 || (value >= Math.fround(0.01) && value <= 100))) {
    throw new WireError("a tree's scale must lie in 0.01..100");
  }
  return trees;
}

// ---- server to client ----------------------------------------------------------------------------

/** Answer to Hello: who serves, which wire version, how many frames a second. */
export interface Welcome {
  type: "welcome";
  server: string;
  version: number;
  tick_hz: number;
}

/** A piece of a table file, from byte `offset` of `total`. */
export interface TableChunk {
  type: "table";
  table: string;
  offset: number;
  total: number;
  data: Uint8Array<ArrayBuffer>;
}

/** `count` rows of `modes` numbers each. */
export interface Rows {
  count: number;
  modes: number;
  values: Int32Array<ArrayBuffer> | Int16Array<ArrayBuffer>;
}

/** Poses of every tree in units of its table's modes.scale: absolute if `key`, else to be added. */
export interface Frame {
  type: "frame";
  seq: number;
  time_s: number;
  key: boolean;
  groups: Rows[];
}

/** Why the server is about to close the connection. */
export interface Failure {
  type: "error";
  code: string;
  title: string;
  hint: string;
}

/** Answer to Ping. */
export interface Pong {
  type: "pong";
  t: number;
}

/** Answer to WindChange in a stream: the wind and its clock (docs/formats/wind.md). */
export interface WindStateReply {
  type: "windState";
  state: Header;
}

export type Reply = Welcome | TableChunk | Frame | Failure | Pong | WindStateReply;

/** The bytes of a server's message. */
export function encodeReply(reply: Reply): Uint8Array<ArrayBuffer> {
  switch (reply.type) {
    case "welcome": {
      const header = { server: reply.server, version: reply.version, tick_hz: reply.tick_hz };
      return encodeMessage(WELCOME, header);
    }
    case "table": {
      const header = { table: reply.table, offset: reply.offset, total: reply.total };
      return encodeMessage(TABLE, header, reply.data);
    }
    case "error":
      return encodeMessage(ERROR, { code: reply.code, title: reply.title, hint: reply.hint });
    case "pong":
      return encodeMessage(PONG, { t: reply.t });
    case "windState":
      return encodeMessage(WIND_STATE, { state: reply.state });
    case "frame":
      return encodeFrame(reply);
  }
}

/** The message of a server. Throws WireError. */
export function decodeReply(data: ArrayBuffer): Reply {
  const { kind, header, payload } = decodeMessage(data);
  if (kind === FRAME) return decodeFrame(header, payload);
  if (kind === TABLE) return decodeChunk(header, payload);
  if (payload.length) throw new WireError("only FRAME and TABLE messages have a payload");
  switch (kind) {
    case WELCOME:
      only(header, "server", "version", "tick_hz");
      return {
        type: "welcome",
        server: text(header, "server"),
        version: whole(header, "version"),
        tick_hz: number(header, "tick_hz"),
      };
    case ERROR:
      only(header, "code", "title", "hint");
      return {
        type: "error",
        code: text(header, "code"),
        title: text(header, "title"),
        hint: text(header, "hint"),
      };
    case PONG:
      only(header, "t");
      return { type: "pong", t: number(header, "t") };
    case WIND_STATE:
      only(header, "state");
      return { type: "windState", state: textMap(header.state, "state") };
    default:
      throw new WireError(`kind ${kind} is not a message that servers send`, "unknown-kind");
  }
}

function decodeChunk(header: Header, payload: Uint8Array<ArrayBuffer>): TableChunk {
  only(header, "table", "offset", "total");
  const [offset, total] = [whole(header, "offset"), whole(header, "total")];
  if (offset + payload.length > total) throw new WireError("a chunk reaches past the end of its table");
  return { type: "table", table: text(header, "table"), offset, total, data: payload };
}

/** FRAME: int32 rows if key, else int16 rows, group after group. */
export function encodeFrame(frame: Frame): Uint8Array<ArrayBuffer> {
  const header = {
    seq: frame.seq,
    time_s: frame.time_s,
    key: frame.key,
    groups: frame.groups.map(({ count, modes }) => ({ count, modes })),
  };
  const width = frame.key ? 4 : 2;
  const sizes = frame.groups.map((group) => group.values.length * width);
  const payload = new Uint8Array(sizes.reduce((sum, size) => sum + size, 0));
  let offset = 0;
  for (const [index, group] of frame.groups.entries()) {
    const rows = frame.key ? new Int32Array(group.values) : new Int16Array(group.values);
    payload.set(new Uint8Array(rows.buffer), offset);
    offset += sizes[index];
  }
  return encodeMessage(FRAME, header, payload);
}

/** The twin of encodeFrame; the rows are views into the message. Throws WireError. */
export function decodeFrame(header: Header, payload: Uint8Array<ArrayBuffer>): Frame {
  only(header, "seq", "time_s", "key", "groups");
  const key = header.key;
  if (typeof key !== "boolean") throw new WireError("key must be true or false");
  const shapes = entries(header, "groups").map(decodeShape);
  const width = key ? 4 : 2;
  if (payload.length !== shapes.reduce((sum, { count, modes }) => sum + count * modes, 0) * width) {
    throw new WireError("the payload does not have the length that the groups say");
  }
  let offset = payload.byteOffset;
  const groups = shapes.map(({ count, modes }): Rows => {
    const size = count * modes;
    const Kind = key ? Int32Array : Int16Array;
    const values = new Kind(payload.buffer, offset, size);
    offset += size * width;
    return { count, modes, values };
  });
  return { type: "frame", seq: whole(header, "seq"), time_s: number(header, "time_s"), key, groups };
}

function decodeShape(entry: unknown): { count: number; modes: number } {
  const group = textMap(entry, "a group");
  only(group, "count", "modes");
  return { count: whole(group, "count"), modes: whole(group, "modes") };
}
