/** FOREST, the message that requests a forest, and SHARED, which describes one. */
import { FOREST_OPTIONS, MOST_ABOUT_ENTRIES, WIRE_FOREST, WIRE_SHARED } from "../constants";
import { METHODS, type Method, parseMethod } from "../motion/method";
import {
  encodeMessage,
  entries,
  type Header,
  number,
  only,
  text,
  textMap,
  truth,
  WireError,
  whole,
} from "./envelope";

/** `count` trees that share one table (SHA-256 in hex). */
interface Group {
  table: string;
  count: number;
}

/** Data that the creator of a shared forest passes to others; the server does not interpret it. */
export type About = Record<string, string | number | boolean>;

/** What the client requests: tables to compute the poses itself, or a stream of poses of these trees. */
export interface Forest {
  type: "forest";
  mode: "stream" | "table";
  groups: Group[];
  wind: Header;
  time_s: number;
  /** null: the default of each table. */
  pose_easing: number | null;
  /** How poses are computed; "modal" if omitted. */
  method?: Method;
  /** Id of a shared forest; without it the forest is private. */
  share?: string;
  /** Replace the trees of the shared forest by these, for everyone. */
  replant?: boolean;
  about?: About;
  /** Size in bytes of the tables (by SHA-256) that the client already has. */
  have?: Record<string, number>;
  /** Four numbers per tree: x (m), z (m), yaw (rad), scale; may be empty. */
  trees: Float32Array<ArrayBuffer>;
}

/** A shared forest, sent to everyone who joins and whenever its trees are replaced. */
export interface Shared {
  type: "shared";
  share: string;
  groups: Group[];
  pose_easing: number | null;
  method: Method;
  about: About;
  trees: Float32Array<ArrayBuffer>;
}

const plain = (groups: readonly Group[]) => groups.map(({ table, count }) => ({ table, count }));
const bytesOf = ({ buffer, byteOffset, byteLength }: Float32Array<ArrayBuffer>) =>
  new Uint8Array(buffer, byteOffset, byteLength);
const filled = (map: object | undefined) => map !== undefined && Object.keys(map).length > 0;

/** FOREST: groups in the header, four float32 per tree in the payload. */
export function encodeForest(forest: Forest): Uint8Array<ArrayBuffer> {
  const { mode, groups, wind, time_s } = forest;
  const header = { mode, groups: plain(groups), options: options(forest), wind, time_s };
  return encodeMessage(WIRE_FOREST, header, bytesOf(forest.trees));
}

/** The options that differ from their defaults. */
function options(forest: Forest): Header {
  return {
    ...(forest.pose_easing !== null && { pose_easing: forest.pose_easing }),
    ...(forest.method === "paper" && { method: forest.method }),
    ...(forest.share !== undefined && { share: forest.share }),
    ...(forest.replant && { replant: true }),
    ...(filled(forest.about) && { about: forest.about }),
    ...(filled(forest.have) && { have: forest.have }),
  };
}

/** Inverse of encodeForest. Throws WireError. */
export function decodeForest(header: Header, payload: Uint8Array<ArrayBuffer>): Forest {
  only(header, "mode", "groups", "options", "wind", "time_s");
  const mode = text(header, "mode");
  if (mode !== "stream" && mode !== "table") throw new WireError("mode must be 'stream' or 'table'");
  const given = textMap(header.options, "options");
  only(given, ...FOREST_OPTIONS.filter((name) => name in given));
  const groups = entries(header, "groups").map(decodeGroup);
  return {
    type: "forest",
    mode,
    groups,
    wind: textMap(header.wind, "wind"),
    time_s: number(header, "time_s", -1e9, 1e9),
    pose_easing: "pose_easing" in given ? number(given, "pose_easing", 0, 1) : null,
    ...("method" in given && { method: decodeMethod(given) }),
    ...("share" in given && { share: decodeShare(given) }),
    ...("replant" in given && { replant: truth(given, "replant") }),
    ...("about" in given && { about: decodeAbout(given) }),
    ...("have" in given && { have: decodeHave(given) }),
    trees: decodeTrees(payload, mode === "stream" || payload.length ? countTrees(groups) : 0),
  };
}

/** SHARED: the forest's trees in the payload, as in FOREST. */
export function encodeShared(shared: Shared): Uint8Array<ArrayBuffer> {
  const { share, groups, pose_easing, method, about } = shared;
  const header = { share, groups: plain(groups), pose_easing, method, about };
  return encodeMessage(WIRE_SHARED, header, bytesOf(shared.trees));
}

/** Inverse of encodeShared. Throws WireError. */
export function decodeShared(header: Header, payload: Uint8Array<ArrayBuffer>): Shared {
  only(header, "share", "groups", "pose_easing", "method", "about");
  const groups = entries(header, "groups").map(decodeGroup);
  return {
    type: "shared",
    share: decodeShare(header),
    groups,
    pose_easing: header.pose_easing === null ? null : number(header, "pose_easing", 0, 1),
    method: decodeMethod(header),
    about: decodeAbout(header),
    trees: decodeTrees(payload, payload.length ? countTrees(groups) : 0),
  };
}

const countTrees = (groups: readonly Group[]) => groups.reduce((sum, { count }) => sum + count, 0);

function decodeMethod(given: Header): Method {
  const method = parseMethod(text(given, "method"));
  if (!method) throw new WireError(`method must be one of ${METHODS.map((id) => `'${id}'`).join(", ")}`);
  return method;
}

function decodeShare(given: Header): string {
  const share = text(given, "share");
  if (!/^[A-Za-z0-9_-]{1,64}$/.test(share)) {
    throw new WireError("share must be 1 to 64 letters, digits, '-' or '_'");
  }
  return share;
}

function decodeAbout(given: Header): About {
  const about = textMap(given.about, "about");
  const names = Object.keys(about);
  if (names.length > MOST_ABOUT_ENTRIES)
    throw new WireError(`about may have up to ${MOST_ABOUT_ENTRIES} entries`);
  for (const name of names) {
    const value = about[name];
    if (name.length > 64) throw new WireError("names in about may have up to 64 characters");
    if (typeof value === "boolean" || (typeof value === "string" && value.length <= 200)) continue;
    number(about, name, -(2 ** 53), 2 ** 53);
  }
  return about as About;
}

function decodeHave(given: Header): Record<string, number> {
  const have = textMap(given.have, "have");
  for (const table of Object.keys(have)) {
    checkHash(table);
    whole(have, table);
  }
  return have as Record<string, number>;
}

function decodeGroup(entry: unknown): Group {
  const group = textMap(entry, "a group");
  only(group, "table", "count");
  return { table: checkHash(text(group, "table")), count: whole(group, "count") };
}

function checkHash(table: string): string {
  if (!/^[0-9a-f]{64}$/.test(table)) throw new WireError("table must be a SHA-256 in hex");
  return table;
}

function decodeTrees(payload: Uint8Array<ArrayBuffer>, count: number): Float32Array<ArrayBuffer> {
  if (payload.length !== count * 16) {
    throw new WireError(`the payload has ${payload.length} bytes; ${count} trees need ${count * 16}`);
  }
  const trees = new Float32Array(payload.buffer, payload.byteOffset, count * 4);
  if (!trees.every((value) => Math.abs(value) <= 1e6)) {
    throw new WireError("a tree's position, yaw or scale is not a valid number");
  }
  if (!trees.every((value, index) => index % 4 !== 3 || (value >= Math.fround(0.01) && value <= 100))) {
    throw new WireError("a tree's scale must lie in 0.01..100");
  }
  return trees;
}
