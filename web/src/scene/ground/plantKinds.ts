/** The kinds of low plants and other things on the ground: shape, density, how they bend, where they are. */
import type { BufferGeometry } from "three";
import type { Quality } from "../quality";
import { leafBlade } from "../season/looseLeaf";
import type { Tinted } from "../season/palette";
import { SEASON_LOOKS, type Season } from "../season/season";
import { fern, herb, sapling, shrub } from "./plantShapes";
import { mushroom, stone, stump, trunkOnGround } from "./solidShapes";
import type { Trunks } from "./trunks";
import {
  fernAt,
  herbAt,
  leafAt,
  logAt,
  mushroomAt,
  type Plant,
  saplingAt,
  shrubAt,
  stoneAt,
  stumpAt,
} from "./undergrowthPlaces";

export const PLANT_KINDS = [
  "shrub",
  "sapling",
  "fern",
  "herb",
  "leaf",
  "stone",
  "log",
  "stump",
  "mushroom",
] as const;
export type PlantKind = (typeof PLANT_KINDS)[number];

/** Cells along each axis, and their size; null: left out. */
type Cells = readonly [side: number, spacing_m: number] | null;

export interface KindLook {
  readonly shape: () => BufferGeometry;
  /** Cards with a picture; a flat leaf; a body with its own normals, which tilts with the ground. */
  readonly surface: "leafy" | "flat" | "solid";
  /** Its colours by season; null: bodies have their own. */
  readonly tint: Tinted | null;
  readonly cells: Readonly<Record<Quality, Cells>>;
  /** How far its top bends, relative to its height and to the lean of grass, rad. */
  readonly bend: number;
  /** Depth of its foot in the ground, relative to its size and m. */
  readonly sunk: readonly [share: number, depth_m: number];
  readonly castsShadow: boolean;
  /** Lies under the snow. */
  readonly covered: boolean;
  /** Only in these seasons; undefined: all year. */
  readonly seasons?: readonly Season[];
  readonly at: (column: number, row: number, spacing_m: number, trunks: Trunks, season: Season) => Plant;
}

const everywhere = (low: Cells, medium: Cells, high: Cells) => ({ low, medium, high });
const foot = [0, 0.05] as const;

export const KIND_LOOKS: Record<PlantKind, KindLook> = {
  shrub: {
    shape: shrub,
    surface: "leafy",
    tint: "shrub",
    cells: everywhere([18, 2.6], [26, 2.2], [40, 2.2]),
    bend: 0.16,
    sunk: foot,
    castsShadow: true,
    covered: false,
    at: shrubAt,
  },
  sapling: {
    shape: sapling,
    surface: "leafy",
    tint: "sapling",
    cells: everywhere([14, 4.1], [20, 3.7], [28, 3.3]),
    bend: 0.22,
    sunk: foot,
    castsShadow: true,
    covered: false,
    at: saplingAt,
  },
  fern: {
    shape: fern,
    surface: "leafy",
    tint: "fern",
    cells: everywhere(null, [40, 1.15], [64, 1.15]),
    bend: 0.3,
    sunk: foot,
    castsShadow: false,
    covered: true,
    at: fernAt,
  },
  herb: {
    shape: herb,
    surface: "leafy",
    tint: "herb",
    cells: everywhere([40, 0.8], [56, 0.62], [96, 0.5]),
    bend: 0.3,
    sunk: [0, 0.02],
    castsShadow: false,
    covered: true,
    at: herbAt,
  },
  leaf: {
    shape: leafBlade,
    surface: "flat",
    tint: "leaf",
    cells: everywhere(null, [70, 0.36], [120, 0.33]),
    bend: 0,
    sunk: [0, -0.02],
    castsShadow: false,
    covered: true,
    at: (column, row, spacing_m, trunks, season) =>
      leafAt(column, row, spacing_m, trunks, SEASON_LOOKS[season].fallen),
  },
  stone: {
    shape: stone,
    surface: "solid",
    tint: null,
    cells: everywhere([12, 5.3], [18, 4.7], [28, 4.1]),
    bend: 0,
    sunk: [0.3, 0],
    castsShadow: true,
    covered: false,
    at: stoneAt,
  },
  log: {
    shape: trunkOnGround,
    surface: "solid",
    tint: null,
    cells: everywhere([6, 11], [8, 11], [10, 10]),
    bend: 0,
    sunk: [0.006, 0],
    castsShadow: true,
    covered: false,
    at: logAt,
  },
  stump: {
    shape: stump,
    surface: "solid",
    tint: null,
    cells: everywhere([6, 9.3], [10, 9.3], [14, 8.3]),
    bend: 0,
    sunk: [0.12, 0],
    castsShadow: true,
    covered: false,
    at: stumpAt,
  },
  mushroom: {
    shape: mushroom,
    surface: "solid",
    tint: null,
    cells: everywhere(null, [24, 0.8], [40, 0.7]),
    bend: 0,
    sunk: [0.08, 0],
    castsShadow: false,
    covered: true,
    seasons: ["autumn"],
    at: mushroomAt,
  },
};

/** Whether a kind can be seen in a season. */
export function seenIn(kind: PlantKind, season: Season): boolean {
  const { covered, seasons } = KIND_LOOKS[kind];
  if (seasons && !seasons.includes(season)) return false;
  return !(covered && SEASON_LOOKS[season].snow > 0);
}
