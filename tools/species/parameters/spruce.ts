import { scalyBark } from "../pictures/barks";
import { needle } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Norway spruce grown in the open: a cone of many thin boughs down to the ground, with hanging branchlets. */
export const spruce: Species = {
  id: "spruce",
  name: "Norway spruce",
  wood: "spruce",
  form: "open",
  height_m: 20,
  habit: {
    seed: 1103,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
      branch: {
        levels: 2,
        length: { 0: 45, 1: 12, 2: 5 },
        radius: { 0: 1.2, 1: 0.4, 2: 0.5 },
        sections: { 0: 12, 1: 4, 2: 3 },
        gnarliness: { 0: 0.008, 1: 0.03, 2: 0.03 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.012 },
        taper: { 0: 0.6, 1: 0.6, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [33, 20],
        start: 0.09,
        angle_deg: [104, 100, 94, 86, 74, 58],
        length: [13, 12.4, 10.6, 8.2, 5, 1],
        steepest: 1,
        scatter: 0.08,
      },
    ],
    leader: [[0.85, 0.06], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.17,
    taper: 1,
    bough_radius_m: 0.032,
    tip_radius_m: 0.009,
    exponent: 0.5,
    flare: 0.3,
    flare_height_m: 0.3,
  },
  cut: { segments: [9, 4], bark_tile_m: [0.6, 1.2] },
  twigs: {
    count: 520,
    length_m: [0.9, 0.8, 0.45],
    scatter: 0.25,
    radius_m: 0.006,
    angle_deg: [74, 62, 46],
    density: [
      [0.1, 0.2, 0.4, 0.6, 0.8, 1, 1.1],
      [0.3, 1, 1.1, 1],
    ],
    rise: -1.3,
    nodes: 3,
    perNode: 2,
    side_angle_deg: 46,
    side_length: 0.5,
    zigzag: 0,
    colour: [0.13, 0.085, 0.06],
  },
  foliage: {
    cards: 2750,
    size_m: 0.84,
    scatter: 0.2,
    angle_deg: [44, 36, 18],
    lift: -0.7,
    shade: 0.45,
    bough_tint: 0.12,
    card_tint: 0.16,
  },
  leaf: {
    ...needle(0.075),
    palettes: [
      [
        [0.16, 0.29, 0.14],
        [0.2, 0.34, 0.16],
        [0.13, 0.25, 0.13],
      ],
      [
        [0.19, 0.33, 0.16],
        [0.24, 0.38, 0.18],
        [0.15, 0.28, 0.14],
      ],
      [
        [0.14, 0.27, 0.14],
        [0.18, 0.32, 0.16],
        [0.12, 0.23, 0.12],
      ],
      [
        [0.22, 0.36, 0.17],
        [0.18, 0.31, 0.15],
        [0.27, 0.4, 0.19],
      ],
    ],
    vein: [0.3, 0.42, 0.26],
    stem: [0.36, 0.24, 0.15],
    length: 0.043,
    petiole: 0,
    leavesPerCard: 572,
    leavesPerSpray: 560,
    sideShoots: 8,
    fuller: {
      sideShoots: 11,
      sideLength: 0.75,
      sideRise: 3.2,
      shortening: 0.5,
      lessRise: 0.5,
      lowest: 0,
      leavesPerCard: 3400,
      length: 0.033,
    },
    sprayShoots: { sideLength: 0.75, sideRise: 2.8, shortening: 0.6, lowest: 0.05 },
    angle_deg: 50,
  },
  bark: scalyBark(83, { dark: [0.17, 0.11, 0.085], light: [0.5, 0.39, 0.32] }, 14, 20),
  barkRelief: 3,
};

/** Grown in a closed forest: a slender stem with a narrow crown on its upper half. */
export const spruceForest: Species = {
  ...spruce,
  id: "spruce-forest",
  name: "Norway spruce, forest-grown",
  form: "forest",
  height_m: 22,
  habit: {
    ...spruce.habit,
    seed: 1118,
    branching: [
      {
        count: [0, 46],
        start: 1,
        angle_deg: [96, 95, 92, 86, 76, 60],
        length: [5, 6.4, 7, 6.6, 4, 0.8],
        steepest: 1,
        scatter: 0.1,
      },
    ],
  },
  girth: {
    ...spruce.girth,
    breast_radius_m: 0.128,
    taper: 0.78,
    bough_radius_m: 0.017,
    tip_radius_m: 0.0085,
  },
  twigs: {
    ...spruce.twigs,
    count: 280,
    length_m: [0.62, 0.6, 0.42],
    radius_m: 0.005,
    density: [
      [0, 0, 0, 0, 0, 0.3, 1.2],
      [0.4, 1, 1.1, 1],
    ],
  },
  foliage: { ...spruce.foliage, cards: 1650, size_m: 0.585 },
};
