/** Leaf colours of a tree by season, and their weight relative to the leaf texture. Pure. */
import { hashUnit } from "galewood/random";
import type { Rgb } from "../sky/atmosphere";
import type { Season } from "./season";

type Palette = readonly Rgb[];
/** Leaves are bare in winter but for those of evergreens, which have their autumn colours. */
type Palettes = Record<Exclude<Season, "winter">, Palette>;

/** Linear-light leaf colours by species; the first are the most frequent. */
const PALETTES: Record<string, Palettes> = {
  poplar: {
    spring: [
      [0.27, 0.4, 0.07],
      [0.33, 0.42, 0.09],
      [0.22, 0.36, 0.06],
    ],
    summer: [
      [0.105, 0.22, 0.059],
      [0.13, 0.25, 0.068],
      [0.085, 0.19, 0.051],
    ],
    autumn: [
      [0.62, 0.4, 0.035],
      [0.7, 0.47, 0.06],
      [0.56, 0.42, 0.05],
      [0.3, 0.38, 0.05],
    ],
  },
  maple: {
    spring: [
      [0.26, 0.36, 0.05],
      [0.34, 0.37, 0.06],
      [0.36, 0.24, 0.06],
    ],
    summer: [
      [0.06, 0.155, 0.042],
      [0.085, 0.19, 0.051],
      [0.05, 0.13, 0.035],
    ],
    autumn: [
      [0.5, 0.035, 0.02],
      [0.62, 0.09, 0.02],
      [0.42, 0.015, 0.022],
      [0.64, 0.2, 0.025],
      [0.2, 0.33, 0.035],
    ],
  },
  apricot: {
    spring: [
      [0.82, 0.56, 0.6],
      [0.86, 0.68, 0.7],
      [0.78, 0.45, 0.52],
    ],
    summer: [
      [0.1, 0.2, 0.054],
      [0.114, 0.22, 0.059],
      [0.125, 0.24, 0.065],
    ],
    autumn: [
      [0.58, 0.22, 0.05],
      [0.24, 0.34, 0.05],
      [0.6, 0.31, 0.1],
      [0.36, 0.36, 0.05],
    ],
  },
  birch: {
    spring: [
      [0.3, 0.42, 0.08],
      [0.36, 0.45, 0.1],
    ],
    summer: [
      [0.12, 0.23, 0.062],
      [0.135, 0.26, 0.07],
      [0.1, 0.2, 0.054],
    ],
    autumn: [
      [0.7, 0.46, 0.05],
      [0.76, 0.54, 0.08],
      [0.6, 0.36, 0.04],
      [0.38, 0.4, 0.06],
    ],
  },
  oak: {
    spring: [
      [0.32, 0.35, 0.07],
      [0.36, 0.32, 0.08],
      [0.26, 0.34, 0.06],
    ],
    summer: [
      [0.075, 0.165, 0.045],
      [0.099, 0.19, 0.051],
      [0.06, 0.14, 0.038],
    ],
    autumn: [
      [0.42, 0.22, 0.04],
      [0.36, 0.15, 0.03],
      [0.46, 0.29, 0.06],
      [0.22, 0.26, 0.04],
    ],
  },
  beech: {
    spring: [
      [0.3, 0.45, 0.09],
      [0.34, 0.47, 0.12],
    ],
    summer: [
      [0.07, 0.17, 0.046],
      [0.09, 0.2, 0.054],
      [0.055, 0.145, 0.039],
    ],
    autumn: [
      [0.52, 0.2, 0.03],
      [0.6, 0.29, 0.05],
      [0.44, 0.13, 0.025],
      [0.56, 0.4, 0.07],
    ],
  },
  ash: {
    spring: [
      [0.28, 0.38, 0.08],
      [0.31, 0.36, 0.1],
    ],
    summer: [
      [0.1, 0.2, 0.054],
      [0.12, 0.23, 0.062],
    ],
    autumn: [
      [0.55, 0.46, 0.09],
      [0.48, 0.44, 0.1],
      [0.3, 0.36, 0.06],
    ],
  },
  sycamore: {
    spring: [
      [0.27, 0.37, 0.06],
      [0.32, 0.33, 0.07],
    ],
    summer: [
      [0.07, 0.16, 0.043],
      [0.09, 0.18, 0.049],
      [0.055, 0.135, 0.036],
    ],
    autumn: [
      [0.5, 0.33, 0.05],
      [0.42, 0.22, 0.04],
      [0.3, 0.31, 0.05],
      [0.24, 0.16, 0.04],
    ],
  },
  willow: {
    spring: [
      [0.36, 0.44, 0.1],
      [0.42, 0.46, 0.12],
    ],
    summer: [
      [0.13, 0.25, 0.068],
      [0.146, 0.28, 0.076],
    ],
    autumn: [
      [0.5, 0.45, 0.1],
      [0.36, 0.4, 0.09],
      [0.27, 0.35, 0.08],
    ],
  },
  spruce: {
    spring: [
      [0.085, 0.18, 0.05],
      [0.125, 0.235, 0.057],
    ],
    summer: [
      [0.062, 0.137, 0.043],
      [0.078, 0.163, 0.049],
      [0.051, 0.118, 0.041],
    ],
    autumn: [
      [0.059, 0.13, 0.043],
      [0.073, 0.15, 0.049],
    ],
  },
  pine: {
    spring: [
      [0.09, 0.155, 0.055],
      [0.12, 0.18, 0.06],
    ],
    summer: [
      [0.07, 0.135, 0.052],
      [0.078, 0.15, 0.058],
    ],
    autumn: [
      [0.075, 0.13, 0.05],
      [0.1, 0.14, 0.05],
    ],
  },
  larch: {
    spring: [
      [0.27, 0.42, 0.11],
      [0.31, 0.45, 0.13],
    ],
    summer: [
      [0.104, 0.2, 0.054],
      [0.114, 0.22, 0.059],
    ],
    autumn: [
      [0.66, 0.38, 0.05],
      [0.72, 0.46, 0.07],
      [0.56, 0.29, 0.04],
    ],
  },
};

const OTHER_PALETTE: Palettes = {
  spring: [
    [0.27, 0.38, 0.07],
    [0.32, 0.4, 0.09],
  ],
  summer: [
    [0.09, 0.19, 0.051],
    [0.114, 0.22, 0.059],
  ],
  autumn: [
    [0.5, 0.28, 0.05],
    [0.28, 0.33, 0.05],
    [0.45, 0.15, 0.04],
  ],
};

/** Unknown trees keep most of their texture's colours in summer. */
function strengthOf(known: boolean, season: Season): number {
  if (known) return 0.9;
  return season === "summer" ? 0.15 : 0.45;
}

/** Seasonal tint of one tree: linear colour and weight. */
export function leafTint(
  species: string | null,
  treeId: number,
  season: Season = "autumn",
): [number, number, number, number] {
  const own = species ? PALETTES[species] : undefined;
  const palette = (own ?? OTHER_PALETTE)[season === "winter" ? "autumn" : season];
  const pick = Math.floor(palette.length * hashUnit(treeId, 21) ** 1.5);
  const next = palette[Math.min(palette.length - 1, pick + 1)];
  const mix = 0.45 * hashUnit(treeId, 22);
  const light = 0.85 + 0.3 * hashUnit(treeId, 23);
  const channel = (k: 0 | 1 | 2) => light * (palette[pick][k] * (1 - mix) + next[k] * mix);
  return [channel(0), channel(1), channel(2), strengthOf(own !== undefined, season)];
}

/** Colours of low plants by season: of a fresh and of an old leaf. */
const UNDERGROWTH_COLOURS: Record<"shrub" | "fern" | "herb", Record<Season, readonly [Rgb, Rgb]>> = {
  shrub: {
    spring: [
      [0.22, 0.36, 0.06],
      [0.15, 0.27, 0.05],
    ],
    summer: [
      [0.1, 0.2, 0.054],
      [0.06, 0.13, 0.035],
    ],
    autumn: [
      [0.36, 0.26, 0.04],
      [0.3, 0.1, 0.03],
    ],
    winter: [
      [0.1, 0.08, 0.06],
      [0.08, 0.06, 0.05],
    ],
  },
  herb: {
    spring: [
      [0.16, 0.32, 0.06],
      [0.11, 0.24, 0.05],
    ],
    summer: [
      [0.07, 0.17, 0.046],
      [0.05, 0.12, 0.032],
    ],
    autumn: [
      [0.13, 0.17, 0.035],
      [0.22, 0.14, 0.05],
    ],
    winter: [
      [0.16, 0.1, 0.06],
      [0.12, 0.08, 0.05],
    ],
  },
  fern: {
    spring: [
      [0.2, 0.36, 0.05],
      [0.15, 0.3, 0.05],
    ],
    summer: [
      [0.13, 0.26, 0.07],
      [0.08, 0.18, 0.049],
    ],
    autumn: [
      [0.4, 0.27, 0.06],
      [0.26, 0.14, 0.05],
    ],
    winter: [
      [0.2, 0.13, 0.07],
      [0.16, 0.1, 0.06],
    ],
  },
};
/** Kinds of low plants with colours of their own; young trees have those of shrubs. */
export type Tinted = "shrub" | "sapling" | "fern" | "herb" | "leaf";
const WITHERED_RGB: Rgb = [0.24, 0.13, 0.055];

/** Colour of one low plant, or of one leaf on the ground below a crown of this colour; hue: 0 to 1. */
export function undergrowthTint(kind: Tinted, hue: number, season: Season, crown: Rgb | null): Rgb {
  const [a, b] =
    kind === "leaf"
      ? [season === "autumn" && crown ? crown : WITHERED_RGB, WITHERED_RGB]
      : UNDERGROWTH_COLOURS[kind === "sapling" ? "shrub" : kind][season];
  const share = kind === "leaf" ? 0.75 * hue : hue;
  const mix = (c: 0 | 1 | 2) => (a[c] + share * (b[c] - a[c])) * (0.8 + 0.4 * ((hue * 7.3) % 1));
  return [mix(0), mix(1), mix(2)];
}
