/**
 * Continuous level of detail. Every leaf and branch has a rank in [0, 1). A tree shows the pieces whose rank is below
 * its share; a piece shrinks to a point before it disappears. Pure.
 */
import {
  BRANCH_FOOT_WEIGHT,
  LEVEL_SHARES,
  MOST_LEAF_GROWTH,
  RANK_SALT,
  SHRINK_RANK_WIDTH,
} from "../core/constants";
import { hashUnit } from "../core/math/random";
import { type Components, componentCentres, componentRadii } from "./mesh/components";

/** Levels of detail are index prefixes that contain every piece visible up to their share. */
export const LEVEL_COUNT = LEVEL_SHARES.length;
/** Levels of nodes: those of meshes, and a last one of trees that are drawn as cards only. */
export const NODE_LEVEL_COUNT = LEVEL_COUNT + 1;
export const CARD_LEVEL = NODE_LEVEL_COUNT - 1;
/** Share at the second distance of a view. */
const SHARE_AT_SECOND = 0.2;
/** Hysteresis: a tree keeps its finer level until it needs this share of the coarser one. */
const LEVEL_HYSTERESIS = 0.93;
/** Minimum share far away; low enough for the last level. */
const LEAST_SHARE = 0.9 * LEVEL_SHARES[LEVEL_COUNT - 1];

/**
 * Near the eye a tree shows a share above 1, up to 2: its leaf cards give way to finer parts, whose ranks are those of their
 * cards, spread from `NEAR_RANK` to 2.
 */
export const MOST_SHARE = 2;
export const NEAR_RANK = 1 + SHRINK_RANK_WIDTH;
/** The whole near detail is shown up to this share of the distance at which it begins. */
const WHOLE_NEAR_SHARE = 0.6;

/** The rank of a part near the eye in place of a card of this rank. */
export const nearRank = (rank: number): number => NEAR_RANK + (MOST_SHARE - NEAR_RANK) * rank;

/**
 * Share of pieces that a tree shows, by its distance (m): 1 up to the first one, then a power of the distance. Nearer than
 * `near_m` it rises above 1.
 */
export function sharesOf(
  [first_m, second_m]: readonly [number, number],
  near_m = 0,
): (distance_m: number) => number {
  const power = Math.log(SHARE_AT_SECOND) / Math.log(second_m / first_m);
  const least_m = first_m * LEAST_SHARE ** (1 / power);
  return (distance_m) => {
    if (distance_m < near_m)
      return Math.min(MOST_SHARE, 1 + (1 - distance_m / near_m) / (1 - WHOLE_NEAR_SHARE));
    if (distance_m <= first_m) return 1;
    return distance_m >= least_m ? LEAST_SHARE : (distance_m / first_m) ** power;
  };
}

/** The level for a share; `before` is the previous level (255: none), kept within the hysteresis. */
export function levelFor(share: number, before: number): number {
  let level = LEVEL_COUNT - 1;
  while (level > 0 && LEVEL_SHARES[level] < share) level--;
  if (before >= level || before === 255) return level;
  return share < LEVEL_HYSTERESIS * LEVEL_SHARES[before + 1] ? level : before;
}

/** Relative size (0..1) of a piece of this rank at this share; same as in the shader. */
export function pieceSize(rank: number, share: number): number {
  return Math.min(1, Math.max(0, (share * (1 + SHRINK_RANK_WIDTH) - rank) / (SHRINK_RANK_WIDTH * share)));
}

/** The same of a leaf, which gives way near the eye unless it is itself a near part; same as in the shader. */
export const leafSize = (rank: number, share: number): number =>
  pieceSize(rank, share) * (rank < 1 ? 1 - pieceSize(nearRank(rank), share) : 1);

/** Growth factor of the remaining leaves; same as in the shader. */
export const leafGrowth = (share: number): number =>
  Math.min(MOST_LEAF_GROWTH, 1 / Math.sqrt(Math.min(1, share)));

/** Position (xyz) of a leaf vertex at this share, scaled about a point; same as in the shader. */
export function grownLeaf(
  vertex: readonly number[],
  middle: readonly number[],
  rank: number,
  share: number,
): number[] {
  const grown = leafSize(rank, share) * leafGrowth(share);
  return vertex.map((at, axis) => middle[axis] + grown * (at - middle[axis]));
}

/** Rank of each leaf, seeded. */
export function leafRanks(pieces: Components): Float32Array {
  return Float32Array.from({ length: pieces.count }, (_, piece) => hashUnit(piece, RANK_SALT));
}

/** Rank of each branch, longest first; wood that consists of few pieces stays complete. */
export function woodRanks(pieces: Components, positions: ArrayLike<number>): Float32Array {
  const ranks = new Float32Array(pieces.count);
  if (pieces.count < 4) return ranks;
  const radii = componentRadii(pieces, positions, componentCentres(pieces, positions));
  const sorted = [...radii.keys()].sort((a, b) => radii[b] - radii[a]);
  sorted.forEach((piece, place) => {
    ranks[piece] = place / pieces.count;
  });
  return ranks;
}

/** The point to which each branch shrinks: its vertex nearest to the base of the trunk, xyz packed. */
export function branchBases(pieces: Components, positions: ArrayLike<number>): Float32Array {
  const bases = new Float32Array(pieces.count * 3);
  const least = new Float32Array(pieces.count).fill(Number.POSITIVE_INFINITY);
  pieces.ofVertex.forEach((piece, v) => {
    const [x, y, z] = [positions[v * 3], positions[v * 3 + 1], positions[v * 3 + 2]];
    const out = Math.hypot(x, z) + BRANCH_FOOT_WEIGHT * y;
    if (out >= least[piece]) return;
    least[piece] = out;
    bases.set([x, y, z], piece * 3);
  });
  return bases;
}

/** Indices in ascending order of the values, which are at least 0; equal ones in their own order. */
function orderOf(values: Float32Array): Uint32Array {
  const n = values.length;
  // The bits of positive numbers are ordered like the numbers; numbers sort faster than objects with a comparison.
  const bits = new Uint32Array(values.buffer);
  const keys = new Float64Array(n);
  for (let k = 0; k < n; k++) keys[k] = bits[k] * n + k;
  keys.sort();
  const order = new Uint32Array(n);
  for (let k = 0; k < n; k++) order[k] = keys[k] % n;
  return order;
}

/** Triangles sorted by the rank of their piece, and the number of indices of each level. */
export function rankedIndex(
  index: ArrayLike<number>,
  rankOf: (vertex: number) => number,
): { index: Uint32Array; counts: number[] } {
  const rank = new Float32Array(index.length / 3);
  for (let t = 0; t < rank.length; t++) rank[t] = rankOf(index[3 * t]);
  const triangles = orderOf(rank);
  const sorted = new Uint32Array(triangles.length * 3);
  for (let place = 0; place < triangles.length; place++) {
    for (let corner = 0; corner < 3; corner++)
      sorted[3 * place + corner] = index[3 * triangles[place] + corner];
  }
  const counts = LEVEL_SHARES.map((share, level) => {
    const most = level === 0 ? MOST_SHARE : share;
    const beyond = triangles.findIndex((t) => pieceSize(rank[t], most) <= 0);
    return 3 * (beyond < 0 ? triangles.length : beyond);
  });
  return { index: sorted, counts };
}
