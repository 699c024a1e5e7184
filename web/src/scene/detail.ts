/** Coarser versions of a tree for the distance: fewer but larger leaves, only the thicker branches. Pure. */

import { hashUnit } from "../math/random";
import { type Components, componentCentres, componentRadii } from "./components";

/** Share of leaves kept, and of branches (longest first), at each level of detail. */
export const LEVELS = [
  { leaves: 1, wood: 1 },
  { leaves: 0.42, wood: 0.45 },
  { leaves: 0.14, wood: 0.12 },
] as const;

function keepTriangles(index: ArrayLike<number>, kept: (vertex: number) => boolean): Uint32Array {
  const out: number[] = [];
  for (let i = 0; i < index.length; i += 3) {
    if (kept(index[i])) out.push(index[i], index[i + 1], index[i + 2]);
  }
  return Uint32Array.from(out);
}

/** Index of a seeded share of the pieces: a coarser level's leaves are always among the finer level's. */
export function thinLeaves(index: ArrayLike<number>, pieces: Components, share: number): Uint32Array {
  if (share >= 1) return Uint32Array.from(index);
  return keepTriangles(index, (v) => hashUnit(pieces.ofVertex[v], 11) < share);
}

/** Positions with every piece grown about its centre by 1/sqrt(share): the crown covers the same area. */
export function growLeaves(positions: ArrayLike<number>, pieces: Components, share: number): Float32Array {
  const grown = Float32Array.from(positions);
  if (share >= 1) return grown;
  const centres = componentCentres(pieces, positions);
  const factor = Math.min(2.6, 1 / Math.sqrt(share));
  pieces.ofVertex.forEach((piece, v) => {
    for (let axis = 0; axis < 3; axis++) {
      const centre = centres[piece * 3 + axis];
      grown[v * 3 + axis] = centre + (grown[v * 3 + axis] - centre) * factor;
    }
  });
  return grown;
}

/** Index of the longest share of the branches; a mesh in one piece stays whole. */
export function thinWood(
  index: ArrayLike<number>,
  positions: ArrayLike<number>,
  pieces: Components,
  share: number,
): Uint32Array {
  if (share >= 1 || pieces.count < 4) return Uint32Array.from(index);
  const radii = componentRadii(pieces, positions, componentCentres(pieces, positions));
  const sorted = Float32Array.from(radii).sort().reverse();
  const smallest = sorted[Math.min(sorted.length - 1, Math.ceil(sorted.length * share))];
  return keepTriangles(index, (v) => radii[pieces.ofVertex[v]] >= smallest);
}
