/**
 * Variants of a species: every tree lacks some boughs, with their twigs and leaves, and each tree others. Pure.
 */
import { hashUnit } from "galewood/random";
import { ALWAYS, MISSING, STEM } from "galewood/trees";

/** The lot of every bough, in [0, 1): evenly spread, in random order along the stem. */
export function lotsOf(boughs: number): Float32Array {
  const order = [...Array(boughs).keys()].sort((a, b) => hashUnit(a, 71) - hashUnit(b, 71));
  const lots = new Float32Array(boughs);
  order.forEach((bough, place) => {
    lots[bough] = (place + 0.5) / boughs;
  });
  return lots;
}

/** Lot of each piece from its bough. */
export function pieceLots(bough: Int32Array, lots: Float32Array): Float32Array {
  return Float32Array.from(bough, (number) => (number === STEM ? ALWAYS : lots[number]));
}

/** Whether a tree at this place (x, z) has what bears this lot; same as in the shader. */
export function hasLot(lot: number, x: number, z: number): boolean {
  const turned = lot + 0.731 * x + 0.417 * z;
  return lot < 0 || turned - Math.floor(turned) >= MISSING;
}
