/** Where shrubs, ferns and fallen leaves lie: pure functions of the cell of a lattice, the land and the trees. */
import { hashUnit, valueNoise } from "galewood/random";
import { glade } from "./landscape";
import type { Trunks } from "./trunks";

export interface Plant {
  readonly x: number;
  readonly z: number;
  /** Height, m; 0 for none. */
  readonly size_m: number;
  /** Random numbers, 0 to 1. */
  readonly turn: number;
  readonly hue: number;
}

const NO_PLANT: Plant = { x: 0, z: 0, size_m: 0, turn: 0, hue: 0 };
/** Shrubs keep this distance from a trunk, plus a share of their own height, as do ferns. */
const CLEAR_M = { shrub: 0.75, fern: 0.45 } as const;
const WIDTH_SHARE = 0.5;

const smoothstep = (from: number, to: number, x: number) => {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
};

function placeIn(column: number, row: number, spacing_m: number, seed: number) {
  const at = (channel: number) => hashUnit(seed, column, row, channel);
  return { at, x: (column + 0.1 + 0.8 * at(0)) * spacing_m, z: (row + 0.1 + 0.8 * at(1)) * spacing_m };
}

/** Free distance that a plant of this height needs from trunks, m. */
export const clearance_m = (kind: keyof typeof CLEAR_M, size_m: number): number =>
  CLEAR_M[kind] + WIDTH_SHARE * size_m;

/** Shrubs grow in groups, most at the edge of the glade, where light reaches the ground. */
export function shrubAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 211);
  const open = glade(x, z);
  const edge = smoothstep(0.02, 0.25, open) * (1 - smoothstep(0.45, 0.75, open));
  const group = 0.5 + 0.5 * valueNoise(x / 9, z / 9, 977);
  const grows =
    at(2) < (0.12 + 0.75 * edge) * smoothstep(0.38, 0.62, group) * (1 - smoothstep(0.6, 0.8, open));
  const size_m = 0.6 + 1.1 * at(3) ** 1.5;
  if (!grows || trunks.nearest(x, z).away_m < clearance_m("shrub", size_m)) return NO_PLANT;
  return { x, z, size_m, turn: at(4), hue: at(5) };
}

/** Ferns grow in patches in the shade. */
export function fernAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 223);
  const patch = 0.5 + 0.5 * valueNoise(x / 6, z / 6, 991);
  const grows = at(2) < 0.85 * smoothstep(0.52, 0.7, patch) * (1 - smoothstep(0.25, 0.55, glade(x, z)));
  const size_m = 0.35 + 0.4 * at(3);
  if (!grows || trunks.nearest(x, z).away_m < clearance_m("fern", size_m)) return NO_PLANT;
  return { x, z, size_m, turn: at(4), hue: at(5) };
}

export interface FallenLeaf extends Plant {
  /** Place of the crown it came from in the packed crowns; -1 for none. */
  readonly crown: number;
}

/** Single leaves below the crowns and a little beyond; `fallen`: share of the ground that they cover, 0 to 1. */
export function leafAt(
  column: number,
  row: number,
  spacing_m: number,
  trunks: Trunks,
  fallen: number,
): FallenLeaf {
  const { at, x, z } = placeIn(column, row, spacing_m, 227);
  const { away_m, crown } = trunks.nearest(x, z);
  if (crown < 0) return { ...NO_PLANT, crown };
  const below = 1 - smoothstep(0.7, 1.7, away_m / Math.max(0.5, trunks.crownOf(crown).wide_m));
  if (at(2) > fallen * (0.08 + 0.85 * below) || away_m < 0.35) return { ...NO_PLANT, crown };
  return { x, z, size_m: 0.06 + 0.06 * at(3), turn: at(4), hue: at(5), crown };
}
