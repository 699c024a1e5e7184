/**
 * The wire format of /ws/forest, version 1: specified in docs/formats/wire.md, same as
 * server/galewood_server/stream/wire.py.
 *
 * Requests go from client to server, replies from server to client. envelope.ts holds their common part, wireForest.ts
 * and wireFrame.ts the messages with numeric payloads. Decoders validate everything they return.
 */
import {
  decodeMessage,
  encodeMessage,
  type Header,
  number,
  only,
  text,
  textMap,
  truth,
  WireError,
  whole,
} from "./envelope";
import {
  decodeForest,
  decodeShared,
  encodeForest,
  encodeShared,
  FOREST,
  type Forest,
  SHARED,
  type Shared,
} from "./wireForest";
import { decodeFrame, encodeFrame, FRAME, type Frame } from "./wireFrame";
import {
  decodeOfHand,
  decodePulls,
  encodeOfHand,
  encodePulls,
  type Gust,
  PULLS,
  type Pull,
  type Pulls,
  type Release,
} from "./wirePull";

export { VERSION, WireError } from "./envelope";
export type { About, Forest, Group, Shared } from "./wireForest";
export type { Frame, Rows } from "./wireFrame";
export type { Gust, Pull, Pulling, Pulls, Release } from "./wirePull";

const HELLO = 1;
const WIND = 3;
const PING = 4;
const PAUSE = 5;
const RESYNC = 6;
const WELCOME = 65;
const TABLE = 66;
const ERROR = 68;
const PONG = 69;
const WIND_STATE = 70;
const CLOCK = 71;
const PRESENCE = 74;

// ---- client to server ----------------------------------------------------------------------------

/** First message of a client: its name. */
export interface Hello {
  type: "hello";
  client: string;
}

/** A new wind document (docs/formats/wind.md). */
export interface WindChange {
  type: "wind";
  wind: Header;
}

/** Requests a Pong with the same number. */
export interface Ping {
  type: "ping";
  t: number;
}

/** Stops or resumes the forest's clock. */
export interface Pause {
  type: "pause";
  paused: boolean;
}

/** Requests a key frame, because the client cannot apply the deltas. */
export interface Resync {
  type: "resync";
}

export type Request = Hello | Forest | WindChange | Ping | Pause | Resync | Pull | Release | Gust;

/** Encodes a client's message. */
export function encodeRequest(request: Request): Uint8Array<ArrayBuffer> {
  switch (request.type) {
    case "hello":
      return encodeMessage(HELLO, { client: request.client });
    case "wind":
      return encodeMessage(WIND, { wind: request.wind });
    case "ping":
      return encodeMessage(PING, { t: request.t });
    case "pause":
      return encodeMessage(PAUSE, { paused: request.paused });
    case "resync":
      return encodeMessage(RESYNC, {});
    case "forest":
      return encodeForest(request);
    default:
      return encodeOfHand(request);
  }
}

/** Decodes a client's message. Throws WireError. */
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
    case PAUSE:
      only(header, "paused");
      return { type: "pause", paused: truth(header, "paused") };
    case RESYNC:
      only(header);
      return { type: "resync" };
  }
  const ofHand = decodeOfHand(kind, header);
  if (ofHand) return ofHand;
  throw new WireError(`kind ${kind} is not a message that clients send`, "unknown-kind");
}

// ---- server to client ----------------------------------------------------------------------------

/** Answer to Hello: server name, wire version, frames per second. */
export interface Welcome {
  type: "welcome";
  server: string;
  version: number;
  tick_hz: number;
}

/** A chunk of a table file, starting at byte `offset` of `total`. */
export interface TableChunk {
  type: "table";
  table: string;
  offset: number;
  total: number;
  data: Uint8Array<ArrayBuffer>;
}

/** Why the server is about to close the connection. */
export interface Failure {
  type: "error";
  code: string;
  title: string;
  hint: string;
}

/** Answer to Ping, with the server's clock; `made_s` of frames and clocks uses the same clock. */
export interface Pong {
  type: "pong";
  t: number;
  server_s: number;
}

/** The forest's time at `made_s` of the server's clock, and whether it is paused. */
export interface Clock {
  type: "clock";
  time_s: number;
  made_s: number;
  paused: boolean;
}

/** Number of clients of a shared forest, sent to all of them when it changes. */
export interface Presence {
  type: "presence";
  clients: number;
}

/** The forest's wind and its clock (docs/formats/wind.md), after a change or on joining. */
export interface WindStateReply {
  type: "windState";
  state: Header;
}

export type Reply =
  | Welcome
  | TableChunk
  | Frame
  | Failure
  | Pong
  | WindStateReply
  | Clock
  | Presence
  | Pulls
  | Shared;

/** Encodes a server's message. */
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
      return encodeMessage(PONG, { t: reply.t, server_s: reply.server_s });
    case "clock": {
      const header = { time_s: reply.time_s, made_s: reply.made_s, paused: reply.paused };
      return encodeMessage(CLOCK, header);
    }
    case "presence":
      return encodeMessage(PRESENCE, { clients: reply.clients });
    case "shared":
      return encodeShared(reply);
    case "windState":
      return encodeMessage(WIND_STATE, { state: reply.state });
    case "frame":
      return encodeFrame(reply);
    case "pulls":
      return encodePulls(reply);
  }
}

/** Decodes a server's message. Throws WireError. */
export function decodeReply(data: ArrayBuffer): Reply {
  const { kind, header, payload } = decodeMessage(data);
  if (kind === FRAME) return decodeFrame(header, payload);
  if (kind === SHARED) return decodeShared(header, payload);
  if (kind === TABLE) return decodeChunk(header, payload);
  if (payload.length) throw new WireError("only FRAME, TABLE and SHARED messages have a payload");
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
      only(header, "t", "server_s");
      return { type: "pong", t: number(header, "t"), server_s: number(header, "server_s") };
    case CLOCK:
      only(header, "time_s", "made_s", "paused");
      return {
        type: "clock",
        time_s: number(header, "time_s"),
        made_s: number(header, "made_s"),
        paused: truth(header, "paused"),
      };
    case PRESENCE:
      only(header, "clients");
      return { type: "presence", clients: whole(header, "clients") };
    case WIND_STATE:
      only(header, "state");
      return { type: "windState", state: textMap(header.state, "state") };
    case PULLS:
      return decodePulls(header);
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
