/**
 * The branches of a built-in tree as rings: its generator writes each as a tube, ring after ring from its base on, whose last vertex
 * repeats the first one for the seam of the texture, and all vertices of a ring have the same second texture coordinate. Pure.
 */
import { cross, dot, minus, type Point, plus, unit } from "../points";
import type { Wood } from "./rootFlare";

/** A branch: its rings from the base to the tip. */
export interface Tube {
  /** First vertex; those of ring k begin at `first + k · around`. */
  readonly first: number;
  /** Vertices of a ring, with the one that repeats the first. */
  readonly around: number;
  /** Middle (m) and radius (m) of each ring. */
  readonly middles: readonly Point[];
  readonly radii_m: readonly number[];
}

/** A mesh that is drawn over branches. */
export interface BranchMesh {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly uvs: Float32Array;
  readonly index: Uint32Array;
  /** Of each vertex: the vertex of the wood that moves it. */
  readonly hold: Uint32Array;
}

/** A place on the axis of a tube: the point itself (m), the direction of the axis, of unit length, and the radius there (m). */
export interface AxisPlace {
  readonly point: Point;
  readonly along: Point;
  readonly radius_m: number;
  /** Distance from the point that was asked for, m. */
  readonly away_m: number;
}

/** Vertices closer than this (m) are at the same place; rings whose texture coordinates differ by less are one ring. */
const SAME_M = 1e-3;
const SAME_V = 0.01;
const LEAST_AROUND = 4;

const vertexAt = (values: ArrayLike<number>, v: number): Point => [
  values[3 * v],
  values[3 * v + 1],
  values[3 * v + 2],
];

/** Vertices of the ring that begins with a vertex, up to the end of its piece; 0 if it is none. */
function ringFrom({ positions, uvs }: Wood, first: number, end: number): number {
  if (!uvs) return 0;
  let last = first;
  while (last + 1 < end && Math.abs(uvs[2 * last + 3] - uvs[2 * first + 1]) < SAME_V) last++;
  const closed = Math.hypot(...minus(vertexAt(positions, last), vertexAt(positions, first))) < SAME_M;
  return closed && last - first >= LEAST_AROUND - 1 ? last - first + 1 : 0;
}

/** The tube of a piece of the wood whose vertices are those from `first` to before `end`; null if it has fewer than two rings. */
function tubeFrom(wood: Wood, first: number, end: number): Tube | null {
  const around = ringFrom(wood, first, end);
  if (around === 0) return null;
  const middles: Point[] = [];
  const radii_m: number[] = [];
  for (let at = first; at + around <= end && ringFrom(wood, at, end) === around; at += around) {
    const corners = Array.from({ length: around - 1 }, (_, k) => vertexAt(wood.positions, at + k));
    const middle = corners.reduce((sum, corner) => plus(sum, corner, 1 / corners.length), [0, 0, 0] as Point);
    middles.push(middle);
    radii_m.push(corners.reduce((sum, c) => sum + Math.hypot(...minus(c, middle)), 0) / corners.length);
  }
  return middles.length < 2 ? null : { first, around, middles, radii_m };
}

/** The tubes of the wood; pieces that are none are left out. `ofVertex`: the piece of each vertex. */
export function tubesOf(wood: Wood, ofVertex: ArrayLike<number>): Tube[] {
  const tubes: Tube[] = [];
  for (let first = 0; first < ofVertex.length; ) {
    let end = first + 1;
    while (end < ofVertex.length && ofVertex[end] === ofVertex[first]) end++;
    const tube = tubeFrom(wood, first, end);
    if (tube) tubes.push(tube);
    first = end;
  }
  return tubes;
}

/** The place of the axis of a tube that is nearest to a point. */
export function nearestOn({ middles, radii_m }: Tube, point: Point): AxisPlace {
  let best: AxisPlace | null = null;
  for (let k = 0; k + 1 < middles.length; k++) {
    const step = minus(middles[k + 1], middles[k]);
    const share = Math.min(1, Math.max(0, dot(minus(point, middles[k]), step) / (dot(step, step) || 1)));
    const on = plus(middles[k], step, share);
    const away_m = Math.hypot(...minus(point, on));
    if (best && best.away_m <= away_m) continue;
    best = {
      point: on,
      along: unit(step),
      radius_m: radii_m[k] + share * (radii_m[k + 1] - radii_m[k]),
      away_m,
    };
  }
  if (!best) throw new Error("a tube has two rings or more");
  return best;
}

/** A direction without its part along another one of unit length. */
export const across = (direction: Point, along: Point): Point =>
  plus(direction, along, -dot(direction, along));

/** The normal of a surface from two steps along it, on the side of `out`. */
export function normalOf(one: Point, other: Point, out: Point): Point {
  const normal = unit(cross(one, other));
  return dot(normal, out) < 0 ? [-normal[0], -normal[1], -normal[2]] : normal;
}
