/** The messages PULL, RELEASE and GUST of clients, and PULLS. */
import {
  MOST_PULLS_OF_FOREST,
  PULL_FORCE_N,
  PULL_PLACE_M,
  PULL_TARGET_M,
  WIRE_GUST,
  WIRE_PULL,
  WIRE_PULLS,
  WIRE_RELEASE,
} from "../constants";
import { encodeMessage, entries, type Header, number, only, textMap, WireError, whole } from "./envelope";

type Vector = readonly [number, number, number];

/** A hand moves a vertex of the tree at (x, z) by `target` from rest, m, in the tree's frame, scale 1. */
interface PullValues {
  readonly hand: number;
  readonly x: number;
  readonly z: number;
  readonly vertex: number;
  readonly target: Vector;
}
export interface Pull extends PullValues {
  readonly type: "pull";
}

/** Releases the tree of a hand. */
export interface Release {
  readonly type: "release";
  readonly hand: number;
}

/** Sends a gust front through the forest from (x, z), m. */
export interface Gust {
  readonly type: "gust";
  readonly x: number;
  readonly z: number;
}

/** A pull and the force that it exerts, N, in the tree's frame at scale 1. */
interface Pulling extends PullValues {
  readonly force: Vector;
}

/** All pulls of a forest at its time `time_s`. */
export interface Pulls {
  readonly type: "pulls";
  readonly time_s: number;
  readonly pulls: readonly Pulling[];
}

const pullHeader = ({ hand, x, z, vertex, target }: PullValues): Header => ({
  hand,
  x,
  z,
  vertex,
  target: [...target],
});

export function encodeOfHand(request: Pull | Release | Gust): Uint8Array<ArrayBuffer> {
  if (request.type === "pull") return encodeMessage(WIRE_PULL, pullHeader(request));
  if (request.type === "release") return encodeMessage(WIRE_RELEASE, { hand: request.hand });
  return encodeMessage(WIRE_GUST, { x: request.x, z: request.z });
}

/** Decodes PULL, RELEASE or GUST; null for another kind. Throws WireError. */
export function decodeOfHand(kind: number, header: Header): Pull | Release | Gust | null {
  if (kind === WIRE_PULL) {
    only(header, "hand", "x", "z", "vertex", "target");
    return { type: "pull", ...pullValues(header) };
  }
  if (kind === WIRE_RELEASE) {
    only(header, "hand");
    return { type: "release", hand: whole(header, "hand") };
  }
  if (kind !== WIRE_GUST) return null;
  only(header, "x", "z");
  return { type: "gust", x: place(header, "x"), z: place(header, "z") };
}

export function encodePulls({ time_s, pulls }: Pulls): Uint8Array<ArrayBuffer> {
  const list = pulls.map((one) => ({ ...pullHeader(one), force: [...one.force] }));
  return encodeMessage(WIRE_PULLS, { time_s, pulls: list });
}

export function decodePulls(header: Header): Pulls {
  only(header, "time_s", "pulls");
  const list = entries(header, "pulls");
  if (list.length > MOST_PULLS_OF_FOREST)
    throw new WireError(`pulls must have at most ${MOST_PULLS_OF_FOREST} entries`);
  return { type: "pulls", time_s: number(header, "time_s"), pulls: list.map(pulling) };
}

function pulling(value: unknown): Pulling {
  const entry = textMap(value, "a pull");
  only(entry, "hand", "x", "z", "vertex", "target", "force");
  return { ...pullValues(entry), force: vector(entry, "force", PULL_FORCE_N) };
}

const pullValues = (header: Header): PullValues => ({
  hand: whole(header, "hand"),
  x: place(header, "x"),
  z: place(header, "z"),
  vertex: whole(header, "vertex"),
  target: vector(header, "target", PULL_TARGET_M),
});

const place = (header: Header, name: string) => number(header, name, -PULL_PLACE_M, PULL_PLACE_M);

function vector(header: Header, name: string, most: number): Vector {
  const values = entries(header, name);
  if (values.length !== 3) throw new WireError(`${name} must have three numbers`);
  const [x, y, z] = values.map((value) => number({ [name]: value }, name, -most, most));
  return [x, y, z];
}
