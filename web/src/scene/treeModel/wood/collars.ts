/**
 * Branch collars of a built-in tree, whose boughs are pipes that begin on the axis of the stem: where a bough leaves its parent it
 * widens towards it, most along the parent and more below than above, and runs into its surface. Drawn over the first length of the
 * bough, on whose surface it ends. Pure.
 */
import { dot, minus, type Point, plus, pointAlong, unit } from "../points";
import type { Wood } from "./rootFlare";
import { type AxisPlace, across, type BranchMesh, nearestOn, normalOf, type Tube } from "./tubes";

/** So many boughs of a tree have collars, the thickest ones; thinner ones than this (m) have none. */
const MOST_COLLARS = 16;
const LEAST_RADIUS_M = 0.02;
/** Length of a collar from the parent's surface on, and its widening at that surface: above, below and to the sides; relative to the bough's radius. */
const COLLAR_LENGTH = 2.6;
const WIDENED_ABOVE = 0.55;
const WIDENED_BELOW = 0.85;
const WIDENED_ASIDE = 0.3;
/** How fast the widening fades: as this power of the share of the length that is left. */
const FADE_POWER = 2.4;
/** Rings at these shares of the length; before them is one inside the parent. */
const RING_SHARES = [0, 0.3, 1] as const;
/** Depth of the innermost ring, which covers that the parent is a polygon: shares of the parent's and of the bough's radius. */
const SUNK_PARENT = 0.12;
const SUNK_OWN = 0.1;
/** A collar is at most so wide relative to its parent. */
const WIDEST_SHARE = 0.92;
/** Distance from the bough at the end, relative to its radius: too little to be seen. */
const CLEAR_SHARE = 0.005;
/** A bough begins this close to the axis of its parent, relative to the parent's radius. */
const ON_AXIS_SHARE = 0.5;
/** Least cosine between a bough and the normal of its parent: flatter ones would have collars without end. */
const LEAST_FACING = 0.6;

/** A line along a bough's surface, from its first ring on. */
interface Line {
  readonly tube: Tube;
  /** Corner of the ring from which the line starts, as a fraction between two corners. */
  readonly corner: number;
}

/** A place on a line: where, normal and texture of the bough there, and the vertex that moves it. */
interface OnLine {
  readonly place: Point;
  readonly normal: Point;
  readonly uv: readonly [number, number];
  readonly hold: number;
}

/** A mixture of both corners between which a line runs, on one ring. */
function cornerOf({ tube, corner }: Line, ring: number): readonly [number, number, number] {
  const low = Math.floor(corner);
  const from = tube.first + ring * tube.around + low;
  return [from, low === corner ? from : from + 1, corner - low];
}

/** The values of a line on one ring, of so many numbers per vertex. */
function valuesOf(values: Float32Array, size: number, line: Line, ring: number): number[] {
  const [a, b, share] = cornerOf(line, ring);
  return Array.from(
    { length: size },
    (_, k) => values[size * a + k] + share * (values[size * b + k] - values[size * a + k]),
  );
}

/** The place at a distance from the first ring (m) along the axis; before the first and after the last one the line goes on straight. */
function placeOn(wood: Wood, line: Line, along_m: number): OnLine {
  const { middles } = line.tube;
  let ring = 0;
  let left_m = along_m;
  let step_m = Math.hypot(...minus(middles[1], middles[0]));
  while (left_m > step_m && ring + 2 < middles.length) {
    left_m -= step_m;
    ring++;
    step_m = Math.hypot(...minus(middles[ring + 1], middles[ring]));
  }
  const share = left_m / step_m;
  const mixed = (values: Float32Array, size: number) => {
    const [from, to] = [ring, ring + 1].map((one) => valuesOf(values, size, line, one));
    return from.map((value, k) => value + share * (to[k] - value));
  };
  const [a, b, corner] = cornerOf(line, share < 0.5 ? ring : ring + 1);
  return {
    place: mixed(wood.positions, 3) as unknown as Point,
    normal: unit(mixed(wood.normals, 3) as unknown as Point),
    uv: mixed(wood.uvs ?? new Float32Array(0), 2) as unknown as OnLine["uv"],
    hold: corner < 0.5 ? a : b,
  };
}

/** The distance along a straight line (m) at which it leaves a round parent; where it passes beside it, that of its nearest point. */
function leaving_m(from: Point, direction: Point, parent: AxisPlace): number {
  const off = across(minus(from, parent.point), parent.along);
  const flat = across(direction, parent.along);
  const [a, half, c] = [dot(flat, flat), dot(off, flat), dot(off, off) - parent.radius_m ** 2];
  return (Math.sqrt(Math.max(0, half * half - a * c)) - half) / Math.max(a, 1e-6);
}

/** How much a bough of this radius is widened at its parent (m); `up`: how far its direction from the axis points to the tip
 * of the parent; `aside`: across. */
function widening_m(radius_m: number, up: number, aside: number, parent_m: number): number {
  const sides = Math.max(0, Math.min(WIDENED_ASIDE, (WIDEST_SHARE * parent_m) / radius_m - 1));
  const along = up > 0 ? WIDENED_ABOVE : WIDENED_BELOW;
  return radius_m * Math.hypot(along * up, sides * aside);
}

/** Fades from 1 at the parent to 0 at the end of the collar, and is level there. */
export const collarFade = (share: number): number => Math.max(0, 1 - share) ** FADE_POWER;

interface Grid {
  readonly rows: readonly (readonly OnLine[])[];
  /** Normals of the parent where each line leaves it. */
  readonly parents: readonly Point[];
}

/** Places of a collar: for each line around the bough, one inside the parent and one on each ring. */
function gridOf(wood: Wood, tube: Tube, parent: AxisPlace): Grid {
  const direction = unit(minus(tube.middles[1], tube.middles[0]));
  const radius_m = tube.radii_m[0];
  const parents: Point[] = [];
  const corners = tube.around - 1;
  const rows = Array.from({ length: 2 * corners + 1 }, (_, k): OnLine[] => {
    const line: Line = { tube, corner: k / 2 };
    const start = placeOn(wood, line, 0).place;
    const from_m = Math.max(0, leaving_m(start, direction, parent));
    const left = plus(start, direction, from_m);
    const out = unit(across(minus(left, parent.point), parent.along));
    // Widened along the parent's surface, so that the collar stays on it.
    const spread = unit(minus(start, tube.middles[0]));
    const toward = unit(across(spread, out));
    const up = dot(toward, parent.along);
    const wide_m = widening_m(radius_m, up, Math.sqrt(Math.max(0, 1 - up * up)), parent.radius_m);
    const length_m = (COLLAR_LENGTH * radius_m) / Math.max(LEAST_FACING, dot(direction, out));
    const rings = RING_SHARES.map((share): OnLine => {
      const on = placeOn(wood, line, from_m + share * length_m);
      const wider = plus(on.place, toward, wide_m * collarFade(share));
      return { ...on, place: plus(wider, on.normal, CLEAR_SHARE * radius_m) };
    });
    parents.push(unit(across(minus(rings[0].place, parent.point), parent.along)));
    const sunk_m = SUNK_PARENT * parent.radius_m + SUNK_OWN * radius_m;
    return [{ ...rings[0], place: plus(rings[0].place, out, -sunk_m) }, ...rings];
  });
  return { rows, parents };
}

/** Normals of a grid: its own between those of the parent, in which it begins, and those of the bough, on which it ends. */
function gridNormals({ rows, parents }: Grid): Point[][] {
  const around = rows.length - 1;
  const end = rows[0].length - 1;
  return rows.map((row, k) =>
    row.map(({ normal }, ring) => {
      const before = rows[(k + around - 1) % around][ring].place;
      const after = rows[(k + 1) % around][ring].place;
      const length = minus(row[Math.min(end, ring + 1)].place, row[Math.max(0, ring - 1)].place);
      const own = normalOf(minus(after, before), length, normal);
      if (ring === end) return normal;
      return ring < 2 ? unit(pointAlong(own, parents[k], ring === 0 ? 1 : 0.6)) : own;
    }),
  );
}

/** The parent of a bough: the place of another one's axis on which it begins; null if there is none. */
function parentOf(tube: Tube, tubes: readonly Tube[]): AxisPlace | null {
  let best: AxisPlace | null = null;
  for (const other of tubes) {
    if (other === tube) continue;
    const place = nearestOn(other, tube.middles[0]);
    if (place.away_m < ON_AXIS_SHARE * place.radius_m && (!best || place.away_m < best.away_m)) best = place;
  }
  return best;
}

/** The collars of the thickest boughs; null if the wood has none. */
export function branchCollars(wood: Wood, tubes: readonly Tube[]): BranchMesh | null {
  const thick = tubes.filter(({ radii_m }) => radii_m[0] >= LEAST_RADIUS_M);
  const grids: Grid[] = [];
  for (const tube of thick.sort((one, other) => other.radii_m[0] - one.radii_m[0])) {
    if (grids.length === MOST_COLLARS) break; // before looking for more parents: the search takes the most time
    const parent = parentOf(tube, tubes);
    if (parent) grids.push(gridOf(wood, tube, parent));
  }
  return grids.length === 0 ? null : meshOf(grids);
}

/** The grids as triangles, which face outwards as those of the boughs do. */
function meshOf(grids: readonly Grid[]): BranchMesh {
  const vertices: OnLine[] = [];
  const normals: Point[] = [];
  const index: number[] = [];
  for (const grid of grids) {
    const first = vertices.length;
    const height = grid.rows[0].length;
    vertices.push(...grid.rows.flat());
    normals.push(...gridNormals(grid).flat());
    for (let k = 0; k + 1 < grid.rows.length; k++) {
      for (let ring = 0; ring + 1 < height; ring++) {
        const a = first + k * height + ring;
        index.push(a, a + 1, a + height, a + height, a + 1, a + height + 1);
      }
    }
  }
  return {
    positions: Float32Array.from(vertices.flatMap(({ place }) => place)),
    normals: Float32Array.from(normals.flat()),
    uvs: Float32Array.from(vertices.flatMap(({ uv }) => uv)),
    index: Uint32Array.from(index),
    hold: Uint32Array.from(vertices, ({ hold }) => hold),
  };
}
