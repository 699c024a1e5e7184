/**
 * The wire format of /ws/forest, version 1: specified in spec/formats/wire.md.
 *
 * Requests go from client to server, replies from server to client. envelope.ts holds their common part, wireForest.ts
 * and wireFrame.ts the messages with numeric payloads. Decoders validate everything they return.
 */
import {
  WIRE_CLOCK,
  WIRE_ERROR,
  WIRE_FOREST,
  WIRE_FRAME,
  WIRE_HELLO,
  WIRE_PAUSE,
  WIRE_PING,
  WIRE_PONG,
  WIRE_PRESENCE,
  WIRE_PULLS,
  WIRE_RESYNC,
  WIRE_SHARED,
  WIRE_TABLE,
  WIRE_WELCOME,
  WIRE_WIND,
  WIRE_WIND_STATE,
} from "../constants";
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
  type Forest,
  type Shared,
} from "./wireForest";
import { decodeFrame, encodeFrame, type Frame } from "./wireFrame";
import {
  decodeOfHand,
  decodePulls,
  encodeOfHand,
  encodePulls,
  type Gust,
  type Pull,
  type Pulls,
  type Release,
} from "./wirePull";

export { WireError } from "./envelope";
export type { About, Forest } from "./wireForest";
export type { Frame } from "./wireFrame";
export type { Pulls } from "./wirePull";

// ---- client to server ----------------------------------------------------------------------------

/** First message of a client: its name. */
interface Hello {
  type: "hello";
  client: string;
}

/** A new wind document (spec/formats/wind.md). */
interface WindChange {
  type: "wind";
  wind: Header;
}

/** Requests a Pong with the same number. */
interface Ping {
  type: "ping";
  t: number;
}

/** Stops or resumes the forest's clock. */
interface Pause {
  type: "pause";
  paused: boolean;
}

/** Requests a key frame, because the client cannot apply the deltas. */
interface Resync {
  type: "resync";
}

export type Request = Hello | Forest | WindChange | Ping | Pause | Resync | Pull | Release | Gust;

/** Encodes a client's message. */
export function encodeRequest(request: Request): Uint8Array<ArrayBuffer> {
  switch (request.type) {
    case "hello":
      return encodeMessage(WIRE_HELLO, { client: request.client });
    case "wind":
      return encodeMessage(WIRE_WIND, { wind: request.wind });
    case "ping":
      return encodeMessage(WIRE_PING, { t: request.t });
    case "pause":
      return encodeMessage(WIRE_PAUSE, { paused: request.paused });
    case "resync":
      return encodeMessage(WIRE_RESYNC, {});
    case "forest":
      return encodeForest(request);
    default:
      return encodeOfHand(request);
  }
}

/** Decodes a client's message. Throws WireError. */
export function decodeRequest(data: ArrayBuffer): Request {
  const { kind, header, payload } = decodeMessage(data);
  if (kind === WIRE_FOREST) return decodeForest(header, payload);
  if (payload.length) throw new WireError("only a FOREST message has a payload");
  switch (kind) {
    case WIRE_HELLO:
      only(header, "client");
      return { type: "hello", client: text(header, "client").slice(0, 200) };
    case WIRE_WIND:
      only(header, "wind");
      return { type: "wind", wind: textMap(header.wind, "wind") };
    case WIRE_PING:
      only(header, "t");
      return { type: "ping", t: number(header, "t") };
    case WIRE_PAUSE:
      only(header, "paused");
      return { type: "pause", paused: truth(header, "paused") };
    case WIRE_RESYNC:
      only(header);
      return { type: "resync" };
  }
  const ofHand = decodeOfHand(kind, header);
  if (ofHand) return ofHand;
  throw new WireError(`kind ${kind} is not a message that clients send`, "unknown-kind");
}

// ---- server to client ----------------------------------------------------------------------------

/** Answer to Hello: server name, wire version, frames per second. */
interface Welcome {
  type: "welcome";
  server: string;
  version: number;
  tick_hz: number;
}

/** A chunk of a table file, starting at byte `offset` of `total`. */
interface TableChunk {
  type: "table";
  table: string;
  offset: number;
  total: number;
  data: Uint8Array<ArrayBuffer>;
}

/** Why the server is about to close the connection. */
interface Failure {
  type: "error";
  code: string;
  title: string;
  hint: string;
}

/** Answer to Ping, with the server's clock; `made_s` of frames and clocks uses the same clock. */
interface Pong {
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
interface Presence {
  type: "presence";
  clients: number;
}

/** The forest's wind and its clock (spec/formats/wind.md), after a change or on joining. */
interface WindStateReply {
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
      return encodeMessage(WIRE_WELCOME, header);
    }
    case "table": {
      const header = { table: reply.table, offset: reply.offset, total: reply.total };
      return encodeMessage(WIRE_TABLE, header, reply.data);
    }
    case "error":
      return encodeMessage(WIRE_ERROR, { code: reply.code, title: reply.title, hint: reply.hint });
    case "pong":
      return encodeMessage(WIRE_PONG, { t: reply.t, server_s: reply.server_s });
    case "clock": {
      const header = { time_s: reply.time_s, made_s: reply.made_s, paused: reply.paused };
      return encodeMessage(WIRE_CLOCK, header);
    }
    case "presence":
      return encodeMessage(WIRE_PRESENCE, { clients: reply.clients });
    case "shared":
      return encodeShared(reply);
    case "windState":
      return encodeMessage(WIRE_WIND_STATE, { state: reply.state });
    case "frame":
      return encodeFrame(reply);
    case "pulls":
      return encodePulls(reply);
  }
}

/** Decodes a server's message. Throws WireError. */
export function decodeReply(data: ArrayBuffer): Reply {
  const { kind, header, payload } = decodeMessage(data);
  if (kind === WIRE_FRAME) return decodeFrame(header, payload);
  if (kind === WIRE_SHARED) return decodeShared(header, payload);
  if (kind === WIRE_TABLE) return decodeChunk(header, payload);
  if (payload.length) throw new WireError("only FRAME, TABLE and SHARED messages have a payload");
  switch (kind) {
    case WIRE_WELCOME:
      only(header, "server", "version", "tick_hz");
      return {
        type: "welcome",
        server: text(header, "server"),
        version: whole(header, "version"),
        tick_hz: number(header, "tick_hz"),
      };
    case WIRE_ERROR:
      only(header, "code", "title", "hint");
      return {
        type: "error",
        code: text(header, "code"),
        title: text(header, "title"),
        hint: text(header, "hint"),
      };
    case WIRE_PONG:
      only(header, "t", "server_s");
      return { type: "pong", t: number(header, "t"), server_s: number(header, "server_s") };
    case WIRE_CLOCK:
      only(header, "time_s", "made_s", "paused");
      return {
        type: "clock",
        time_s: number(header, "time_s"),
        made_s: number(header, "made_s"),
        paused: truth(header, "paused"),
      };
    case WIRE_PRESENCE:
      only(header, "clients");
      return { type: "presence", clients: whole(header, "clients") };
    case WIRE_WIND_STATE:
      only(header, "state");
      return { type: "windState", state: textMap(header.state, "state") };
    case WIRE_PULLS:
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
