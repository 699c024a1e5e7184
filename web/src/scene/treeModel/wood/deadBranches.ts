/**
 * Dead branches of a built-in tree on the stem below its crown, where the shade has killed them: short, thin and broken off, more of
 * them the higher, and most on evergreens, which shed them late. Drawn over the stem, which moves them. Pure.
 */
import { hashUnit } from "galewood/random";
import { between, cross, dot, minus, type Point, plus, pointAlong, unit } from "../points";
import type { Wood } from "./rootFlare";
import { across, type BranchMesh, type Tube } from "./tubes";

export interface DeadBranches extends BranchMesh {
  /** Of each vertex: the foot of its branch on the axis of the stem (m), and a number of this branch in [0, 1). */
  readonly feet: Float32Array;
}

/** The part of the clear stem that still has dead branches, from the crown down. */
const ZONE_SHARE = 0.7;
/** No branches below this height: people and animals have broken them off. */
const LEAST_HEIGHT_M = 1.2;
/** Boughs thinner than this (m) do not say where the crown begins. */
const BOUGH_RADIUS_M = 0.015;

interface Habit {
  readonly per_m: number;
  readonly most: number;
  /** Shortest and longest, m. */
  readonly length_m: readonly [number, number];
  /** Least and largest angle above the horizontal, rad. */
  readonly rise_rad: readonly [number, number];
}

/** By eye, after stands of the species; spruces and pines keep dry branches for decades, broadleaves shed them within years. */
const EVERGREEN_HABIT: Habit = { per_m: 4, most: 24, length_m: [0.3, 1.3], rise_rad: [-0.45, 0.1] };
const BROADLEAF_HABIT: Habit = { per_m: 1.2, most: 8, length_m: [0.12, 0.7], rise_rad: [0.1, 0.7] };

/** Radius at the foot (m), at the bend and at the end relative to it. */
const FOOT_RADIUS_M: readonly [number, number] = [0.008, 0.022];
const BEND_RADIUS_SHARE = 0.7;
const END_RADIUS_SHARE = 0.35;
/** At the bend, the branch is this far from its straight line, relative to its length. */
const BEND_SHARE = 0.08;
const CORNER_COUNT = 5;
const RANDOM_CHANNEL = 83;

const mix = ([low, high]: readonly [number, number], share: number) => low + share * (high - low);

/** The thickest tube. */
const stemOf = (tubes: readonly Tube[]): Tube | undefined =>
  [...tubes].sort((a, b) => b.radii_m[0] - a.radii_m[0])[0];

/** A place on the stem at a height: the axis, its direction, the radius, and the first vertex of the nearer ring. */
function stemAt({ middles, radii_m, first, around }: Tube, height_m: number) {
  let ring = 0;
  while (ring + 2 < middles.length && middles[ring + 1][1] < height_m) ring++;
  const [low, high] = [middles[ring], middles[ring + 1]];
  const share = Math.min(1, Math.max(0, (height_m - low[1]) / (high[1] - low[1] || 1)));
  return {
    axis: pointAlong(low, high, share),
    along: unit(minus(high, low)),
    radius_m: radii_m[ring] + share * (radii_m[ring + 1] - radii_m[ring]),
    middle: share < 0.5 ? low : high,
    first: first + (share < 0.5 ? ring : ring + 1) * around,
  };
}

/** Vertices of a branch: three rings from inside the stem to the end. */
function branchAt(wood: Wood, stem: Tube, height_m: number, number: number, habit: Habit) {
  const random = (channel: number) => hashUnit(number, RANDOM_CHANNEL, channel);
  const at = stemAt(stem, height_m);
  const turn = unit(across([1, 0, 0], at.along));
  const out = between(turn, cross(at.along, turn), 2 * Math.PI * random(0));
  const along = between(out, at.along, mix(habit.rise_rad, random(1)));
  // Most are short.
  const length_m = mix(habit.length_m, random(2) ** 1.5);
  const foot_m = Math.min(mix(FOOT_RADIUS_M, random(3)), 0.3 * at.radius_m);
  const side = unit(cross(along, at.along));
  const up = cross(side, along);
  const start = plus(at.axis, out, 0.85 * at.radius_m);
  const bend = plus(
    plus(start, along, 0.55 * length_m),
    between(side, up, 6 * random(4)),
    BEND_SHARE * length_m,
  );
  const rings: [Point, number][] = [
    [start, foot_m],
    [bend, BEND_RADIUS_SHARE * foot_m],
    [plus(start, along, length_m), END_RADIUS_SHARE * foot_m],
  ];
  const [positions, normals]: Point[][] = [[], []];
  for (const [middle, radius_m] of rings) {
    for (let k = 0; k < CORNER_COUNT; k++) {
      const normal = between(side, up, (2 * Math.PI * k) / CORNER_COUNT);
      positions.push(plus(middle, normal, radius_m));
      normals.push(normal);
    }
  }
  return { positions, normals, foot: at.axis, key: random(5), hold: facing(wood, at, stem.around, out) };
}

/** The vertex of a ring that faces a direction most. */
function facing(
  { positions }: Wood,
  { first, middle }: { first: number; middle: Point },
  around: number,
  out: Point,
): number {
  let best = first;
  let most = Number.NEGATIVE_INFINITY;
  for (let v = first; v < first + around; v++) {
    const place: Point = [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]];
    const towards_m = dot(minus(place, middle), out);
    if (towards_m > most) [best, most] = [v, towards_m];
  }
  return best;
}

/** Heights of the feet (m): more of them towards the crown. */
function feetBelow(crown_m: number, { per_m, most }: Habit): number[] {
  const from_m = Math.max(LEAST_HEIGHT_M, (1 - ZONE_SHARE) * crown_m);
  const zone_m = crown_m - from_m;
  const count = Math.min(most, Math.round(per_m * zone_m));
  return Array.from(
    { length: Math.max(0, count) },
    (_, k) => from_m + zone_m * Math.sqrt((k + hashUnit(k, RANDOM_CHANNEL, 6)) / count),
  );
}

/** The dead branches of a tree; null if its crown begins too low, or it has no stem of rings. */
export function deadBranches(wood: Wood, tubes: readonly Tube[], evergreen: boolean): DeadBranches | null {
  const stem = stemOf(tubes);
  if (!stem) return null;
  const boughs = tubes.filter((tube) => tube !== stem && tube.radii_m[0] >= BOUGH_RADIUS_M);
  if (boughs.length === 0) return null;
  const crown_m = Math.min(...boughs.map(({ middles }) => middles[0][1]));
  const habit = evergreen ? EVERGREEN_HABIT : BROADLEAF_HABIT;
  const branches = feetBelow(crown_m, habit).map((height_m, k) => branchAt(wood, stem, height_m, k, habit));
  if (branches.length === 0) return null;
  const vertices = branches.flatMap((branch) => branch.positions.map(() => branch));
  return {
    positions: Float32Array.from(branches.flatMap(({ positions }) => positions.flat())),
    normals: Float32Array.from(branches.flatMap(({ normals }) => normals.flat())),
    uvs: Float32Array.from(
      vertices.flatMap(({ hold }) => [wood.uvs?.[2 * hold] ?? 0, wood.uvs?.[2 * hold + 1] ?? 0]),
    ),
    index: Uint32Array.from(branches.flatMap((branch, k) => ringIndex(k * branch.positions.length))),
    hold: Uint32Array.from(vertices, ({ hold }) => hold),
    feet: Float32Array.from(vertices.flatMap(({ foot, key }) => [...foot, key])),
  };
}

/** Triangles between the rings of a branch whose vertices begin here, facing outwards. */
function ringIndex(first: number): number[] {
  return [0, 1].flatMap((ring) =>
    Array.from({ length: CORNER_COUNT }, (_, k) => {
      const [a, b] = [k, (k + 1) % CORNER_COUNT].map((corner) => first + ring * CORNER_COUNT + corner);
      return [a, a + CORNER_COUNT, b, b, a + CORNER_COUNT, b + CORNER_COUNT];
    }).flat(),
  );
}
