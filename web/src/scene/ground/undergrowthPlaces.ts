/** Where low plants, stones, dead wood and fallen leaves lie: pure functions of the cell of a lattice, the land and the trees. */
import { hashUnit, valueNoise } from "galewood/random";
import { smoothstep } from "../sky/weather";
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
  /** Of a fallen leaf: place of the crown it came from in the packed crowns. */
  readonly crown?: number;
}

const NO_PLANT: Plant = { x: 0, z: 0, size_m: 0, turn: 0, hue: 0 };
/** Plants and stones keep this distance from a trunk, plus a share of their own height. */
const CLEAR_M = {
  shrub: 0.75,
  sapling: 0.9,
  fern: 0.45,
  herb: 0.15,
  stone: 0.5,
  stump: 0.9,
  mushroom: 0.3,
} as const;
const WIDTH_SHARE = 0.5;
/** Least distance of a fallen trunk from those that stand, along its length, m. */
const LOG_CLEAR_M = 0.45;

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
  return grows
    ? clearOf("shrub", { x, z, size_m: 0.6 + 1.1 * at(3) ** 1.5, turn: at(4), hue: at(5) }, trunks)
    : NO_PLANT;
}

/** Ferns grow in patches in the shade. */
export function fernAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 223);
  const patch = 0.5 + 0.5 * valueNoise(x / 6, z / 6, 991);
  const grows = at(2) < 0.85 * smoothstep(0.52, 0.7, patch) * (1 - smoothstep(0.25, 0.55, glade(x, z)));
  return grows
    ? clearOf("fern", { x, z, size_m: 0.35 + 0.4 * at(3), turn: at(4), hue: at(5) }, trunks)
    : NO_PLANT;
}

/** Young trees grow where the crowns leave gaps, in groups. */
export function saplingAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 229);
  const group = 0.5 + 0.5 * valueNoise(x / 13, z / 13, 983);
  const grows = at(2) < 0.5 * smoothstep(0.4, 0.7, group) * (1 - smoothstep(0.5, 0.7, glade(x, z)));
  return grows
    ? clearOf("sapling", { x, z, size_m: 0.8 + 2.2 * at(3) ** 2, turn: at(4), hue: at(5) }, trunks)
    : NO_PLANT;
}

/** Herbs cover the ground in the shade in patches, fewer where grass grows. */
export function herbAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 233);
  const patch = 0.5 + 0.5 * valueNoise(x / 4.5, z / 4.5, 997);
  const grows =
    at(2) < (0.08 + 0.8 * smoothstep(0.45, 0.7, patch)) * (1 - 0.85 * smoothstep(0.3, 0.7, glade(x, z)));
  return grows
    ? clearOf("herb", { x, z, size_m: 0.12 + 0.16 * at(3), turn: at(4), hue: at(5) }, trunks)
    : NO_PLANT;
}

/** Stones lie in swarms, most of them small. */
export function stoneAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 239);
  const swarm = 0.5 + 0.5 * valueNoise(x / 17, z / 17, 1009);
  if (at(2) >= 0.5 * smoothstep(0.5, 0.75, swarm)) return NO_PLANT;
  return clearOf("stone", { x, z, size_m: 0.12 + 0.7 * at(3) ** 4, turn: at(4), hue: at(5) }, trunks);
}

/** Stumps stand where a tree has been felled, none in the glade. */
export function stumpAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 241);
  if (at(2) >= 0.16 || glade(x, z) > 0.4) return NO_PLANT;
  return clearOf("stump", { x, z, size_m: 0.3 + 0.3 * at(3), turn: at(4), hue: at(5) }, trunks);
}

/** Mushrooms grow in groups near the trees. */
export function mushroomAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 251);
  const group = 0.5 + 0.5 * valueNoise(x / 1.6, z / 1.6, 1013);
  if (at(2) >= smoothstep(0.72, 0.85, group) || glade(x, z) > 0.3) return NO_PLANT;
  return clearOf("mushroom", { x, z, size_m: 0.05 + 0.08 * at(3), turn: at(4), hue: at(5) }, trunks);
}

/** Fallen trunks; `size_m` is the length. They lie across no standing one. */
export function logAt(column: number, row: number, spacing_m: number, trunks: Trunks): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 257);
  if (at(2) >= 0.45 || glade(x, z) > 0.5) return NO_PLANT;
  const size_m = 3.5 + 3.5 * at(3);
  const turn = at(4);
  const [cos, sin] = [Math.cos(2 * Math.PI * turn), Math.sin(2 * Math.PI * turn)];
  for (let along_m = -0.5 * size_m; along_m <= 0.5 * size_m; along_m += LOG_CLEAR_M) {
    // The shader turns x towards z.
    const { away_m } = trunks.nearest(x + along_m * cos, z + along_m * sin);
    if (away_m < LOG_CLEAR_M + 0.06 * size_m) return NO_PLANT;
  }
  return { x, z, size_m, turn, hue: at(5) };
}

/** The plant, unless a trunk is too near. */
function clearOf(kind: keyof typeof CLEAR_M, plant: Plant, trunks: Trunks): Plant {
  return trunks.nearest(plant.x, plant.z).away_m < clearance_m(kind, plant.size_m) ? NO_PLANT : plant;
}

/** Single leaves below the crowns and a little beyond; `fallen`: share of the ground that they cover, 0 to 1. */
export function leafAt(
  column: number,
  row: number,
  spacing_m: number,
  trunks: Trunks,
  fallen: number,
): Plant {
  const { at, x, z } = placeIn(column, row, spacing_m, 227);
  const { away_m, crown } = trunks.nearest(x, z);
  if (crown < 0) return NO_PLANT;
  const { wide_m, sheds } = trunks.crownOf(crown);
  if (!sheds) return NO_PLANT;
  const below = 1 - smoothstep(0.7, 1.7, away_m / Math.max(0.5, wide_m));
  if (at(2) > fallen * (0.08 + 0.85 * below) || away_m < 0.35) return NO_PLANT;
  return { x, z, size_m: 0.06 + 0.06 * at(3), turn: at(4), hue: at(5), crown };
}
