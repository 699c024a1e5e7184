/**
 * Variants of a species: every tree lacks some limbs, with their twigs and leaves, and each tree others. Pure.
 */
import { hashUnit } from "galewood/random";
import { COMMON_KEY, MISSING_BRANCH_SHARE, STEM_LIMB } from "galewood/trees";

/** The key of every limb, in [0, 1): evenly spread, in random order along the stem. */
export function limbKeysOf(limbs: number): Float32Array {
  const order = [...Array(limbs).keys()].sort((a, b) => hashUnit(a, 71) - hashUnit(b, 71));
  const keys = new Float32Array(limbs);
  order.forEach((limb, place) => {
    keys[limb] = (place + 0.5) / limbs;
  });
  return keys;
}

/** Key of each piece from its limb. */
export function pieceKeys(limb: Int32Array, keys: Float32Array): Float32Array {
  return Float32Array.from(limb, (number) => (number === STEM_LIMB ? COMMON_KEY : keys[number]));
}

/** Whether a tree at this place (x, z) has the pieces of this key; same as in the shader. */
export function hasVariant(key: number, x: number, z: number): boolean {
  const turned = key + 0.731 * x + 0.417 * z;
  return key < 0 || turned - Math.floor(turned) >= MISSING_BRANCH_SHARE;
}
