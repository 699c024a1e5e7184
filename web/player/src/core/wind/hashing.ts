/** Seeded hashes, identical in every language. */
import { HASH_FACTOR, HASH_GOLDEN } from "../constants";

/** Mueller's integer finaliser of (seed, k), 0 … 2³²−1. */
export function hash32(seed: number, k: number): number {
  let h = (seed + Math.imul(HASH_GOLDEN, k + 1)) >>> 0;
  for (let round = 0; round < 2; round++) h = Math.imul(h ^ (h >>> 16), HASH_FACTOR) >>> 0;
  return (h ^ (h >>> 16)) >>> 0;
}

/** A value in [−1, 1), exact. */
export const signedUniform = (seed: number, k: number): number => hash32(seed, k) / 2147483648 - 1;

/** A phase in [0, 1) turns. */
export const phaseTurns = (seed: number, k: number): number => hash32(seed, k) / 4294967296;
