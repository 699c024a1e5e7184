import { apricotBark, type Bark, mapleBark, poplarBark } from "./bark-picture";
import { TreePreset } from "./ez-tree";
import type { Foliage } from "./foliage";
import type { Habit } from "./growth";
import type { LeafLook } from "./leaf-picture";
import { deltoid, ovate, palmate } from "./leaf-shapes";
import type { Girth } from "./skeleton";
import type { WoodCut } from "./wood";

/** All that is needed to grow one species. */
export interface Species {
  id: string;
  name: string;
  /** Key of its wood in the precompute's table of species. */
  wood: string;
  /** Height of the topmost wood, m; leaves stand a little above it. */
  height_m: number;
  habit: Habit;
  girth: Girth;
  cut: WoodCut;
  foliage: Foliage;
  leaf: LeafLook;
  bark: Bark;
  /** Strength of the bark's relief in its normal picture. */
  barkRelief: number;
}

const twoLevels = { type: "deciduous", trellis: { enabled: false } };

const poplar: Species = {
  id: "poplar",
  name: "Poplar",
  wood: "poplar",
  height_m: 14,
  habit: {
    seed: 404,
    options: {
      ...TreePreset["Aspen Large"],
      branch: {
        ...TreePreset["Aspen Large"].branch,
        length: { 0: 45, 1: 15, 2: 6 },
        radius: { 0: 1.1, 1: 0.5, 2: 0.7 },
        sections: { 0: 12, 1: 4, 2: 3 },
        gnarliness: { 0: 0.03, 1: 0.05, 2: 0.07 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.02 },
      },
    },
    branching: [
      {
        count: [20, 5, 1],
        start: 0.26,
        angle_deg: [66, 64, 58, 50, 42, 34],
        length: [11, 12, 11.5, 10.5, 8, 4],
        steepest: 1,
        scatter: 0.16,
      },
      {
        count: [1, 1],
        start: 0.3,
        angle_deg: [55, 48, 40],
        length: [6, 5.5, 4],
        steepest: 0.75,
        scatter: 0.2,
      },
    ],
    leader: [[0.34, 0.4], [0.45], []],
  },
  girth: {
    breast_radius_m: 0.11,
    breast_height_m: 1.3,
    tip_radius_m: 0.011,
    exponent: 0.5,
    flare: 0.35,
    flare_height_m: 0.25,
  },
  cut: { segments: [8, 5, 4], bark_tile_m: [0.7, 1.6] },
  foliage: {
    cards: 2700,
    size_m: 0.5,
    scatter: 0.25,
    angle_deg: [70, 60, 40],
    density: [
      [0, 0, 0, 0.15, 0.5, 1, 1.3],
      [0.1, 0.6, 1, 1.2],
      [0.5, 1, 1.2],
    ],
    reach_m: 0.4,
    lift: 0.1,
    shade: 0.55,
    bough_tint: 0.25,
    spray_tint: 0.3,
  },
  leaf: {
    ...deltoid(),
    palettes: [
      [
        [0.93, 0.74, 0.16],
        [0.97, 0.8, 0.24],
        [0.88, 0.68, 0.13],
      ],
      [
        [0.95, 0.78, 0.22],
        [0.86, 0.76, 0.24],
        [0.98, 0.83, 0.3],
      ],
      [
        [0.9, 0.66, 0.12],
        [0.95, 0.75, 0.18],
        [0.84, 0.58, 0.12],
      ],
      [
        [0.84, 0.78, 0.26],
        [0.74, 0.74, 0.27],
        [0.93, 0.79, 0.22],
      ],
    ],
    vein: [0.98, 0.9, 0.55],
    stem: [0.55, 0.44, 0.24],
    length: 0.2,
    petiole: 0.42,
    leavesPerCard: 22,
    angle_deg: 52,
  },
  bark: poplarBark(11),
  barkRelief: 2.2,
};

const maple: Species = {
  id: "maple",
  name: "Maple",
  wood: "maple",
  height_m: 12,
  habit: {
    seed: 707,
    options: {
      ...twoLevels,
      branch: {
        levels: 2,
        length: { 0: 30, 1: 14, 2: 7 },
        radius: { 0: 1.5, 1: 0.5, 2: 0.6 },
        sections: { 0: 9, 1: 5, 2: 3 },
        gnarliness: { 0: 0.04, 1: 0.06, 2: 0.08 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.014 },
        taper: { 0: 0.5, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [12, 5, 1],
        start: 0.27,
        angle_deg: [72, 66, 58, 48, 38, 28],
        length: [17, 19, 18.5, 16, 12, 6],
        steepest: 1,
        scatter: 0.14,
      },
      {
        count: [3, 1],
        start: 0.3,
        angle_deg: [60, 52, 42],
        length: [9.5, 8.5, 6],
        steepest: 0.75,
        scatter: 0.2,
      },
    ],
    leader: [[0.46, 0.5], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.14,
    breast_height_m: 1.3,
    tip_radius_m: 0.011,
    exponent: 0.5,
    flare: 0.4,
    flare_height_m: 0.3,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.7, 1.4] },
  foliage: {
    cards: 2750,
    size_m: 0.66,
    scatter: 0.25,
    angle_deg: [75, 65, 45],
    density: [
      [0, 0, 0, 0, 0.4, 0.8, 1.2],
      [0, 0.3, 0.8, 1.2],
      [0.4, 1, 1.3],
    ],
    reach_m: 0.6,
    lift: -0.02,
    shade: 0.5,
    bough_tint: 0.35,
    spray_tint: 0.25,
  },
  leaf: {
    ...palmate(),
    palettes: [
      [
        [0.8, 0.16, 0.1],
        [0.88, 0.24, 0.1],
        [0.72, 0.11, 0.1],
      ],
      [
        [0.86, 0.28, 0.1],
        [0.92, 0.38, 0.12],
        [0.8, 0.19, 0.1],
      ],
      [
        [0.7, 0.1, 0.11],
        [0.78, 0.15, 0.1],
        [0.62, 0.08, 0.11],
      ],
      [
        [0.9, 0.34, 0.12],
        [0.82, 0.2, 0.1],
        [0.95, 0.5, 0.16],
      ],
    ],
    vein: [0.95, 0.55, 0.3],
    stem: [0.5, 0.16, 0.12],
    length: 0.25,
    petiole: 0.38,
    leavesPerCard: 17,
    angle_deg: 55,
  },
  bark: mapleBark(23),
  barkRelief: 4,
};

const apricot: Species = {
  id: "apricot",
  name: "Apricot",
  wood: "apricot",
  height_m: 6,
  habit: {
    seed: 707,
    options: {
      ...twoLevels,
      branch: {
        levels: 2,
        length: { 0: 10, 1: 8, 2: 4 },
        radius: { 0: 1.2, 1: 0.6, 2: 0.6 },
        sections: { 0: 5, 1: 5, 2: 3 },
        gnarliness: { 0: 0.07, 1: 0.09, 2: 0.1 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.012 },
        taper: { 0: 0.3, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [7, 6, 1],
        start: 0.5,
        angle_deg: [64, 62, 60, 54, 46, 34],
        length: [11.5, 12.5, 12, 10.5, 8, 5],
        steepest: 1,
        scatter: 0.14,
      },
      {
        count: [3, 1],
        start: 0.28,
        angle_deg: [58, 50, 42],
        length: [6, 5.5, 4],
        steepest: 0.75,
        scatter: 0.22,
      },
    ],
    leader: [[0.8, 0.5], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.09,
    breast_height_m: 0.7,
    tip_radius_m: 0.008,
    exponent: 0.5,
    flare: 0.3,
    flare_height_m: 0.2,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.55, 1.1] },
  foliage: {
    cards: 2700,
    size_m: 0.42,
    scatter: 0.25,
    angle_deg: [70, 60, 40],
    density: [
      [0, 0, 0, 0.3, 0.7, 1, 1.2],
      [0, 0.4, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    reach_m: 0.32,
    lift: 0.08,
    shade: 0.5,
    bough_tint: 0.2,
    spray_tint: 0.25,
  },
  leaf: {
    ...ovate(),
    palettes: [
      [
        [0.4, 0.62, 0.18],
        [0.47, 0.67, 0.22],
        [0.34, 0.54, 0.17],
      ],
      [
        [0.49, 0.69, 0.25],
        [0.56, 0.74, 0.27],
        [0.43, 0.63, 0.2],
      ],
      [
        [0.34, 0.53, 0.17],
        [0.4, 0.59, 0.19],
        [0.3, 0.48, 0.16],
      ],
      [
        [0.56, 0.72, 0.25],
        [0.47, 0.65, 0.21],
        [0.65, 0.74, 0.27],
      ],
    ],
    vein: [0.66, 0.76, 0.4],
    stem: [0.42, 0.2, 0.13],
    length: 0.21,
    petiole: 0.3,
    leavesPerCard: 24,
    angle_deg: 50,
  },
  bark: apricotBark(37),
  barkRelief: 3.5,
};

export const SPECIES: readonly Species[] = [poplar, maple, apricot];
