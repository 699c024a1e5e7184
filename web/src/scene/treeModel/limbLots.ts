/**
 * Variants of a species: every tree lacks some limbs, with their twigs and leaves, and each tree others. Pure.
 */
import { hashUnit } from "galewood/random";
import { COMMON_LOT, MISSING_BRANCH_SHARE, STEM_LIMB } from "galewood/trees";

/** The lot of every limb, in [0, 1): evenly spread, in random order along the stem. */
export function lotsOf(limbs: number): Float32Array {
  const order = [...Array(limbs).keys()].sort((a, b) => hashUnit(a, 71) - hashUnit(b, 71));
  const lots = new Float32Array(limbs);
  order.forEach((limb, place) => {
    lots[limb] = (place + 0.5) / limbs;
  });
  return lots;
}

/** Lot of each piece from its limb. */
export function pieceLots(limb: Int32Array, lots: Float32Array): Float32Array {
  return Float32Array.from(limb, (number) => (number === STEM_LIMB ? COMMON_LOT : lots[number]));
}

/** Whether a tree at this place (x, z) has the pieces of this lot; same as in the shader. */
export function hasLot(lot: number, x: number, z: number): boolean {
  const turned = lot + 0.731 * x + 0.417 * z;
  return lot < 0 || turned - Math.floor(turned) >= MISSING_BRANCH_SHARE;
}
