import { furrowedBark } from "../pictures/barks";
import { lanceolate } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Weeping willow grown in the open: a short stem, arching boughs, and long shoots that hang like curtains. */
export const willow: Species = {
  id: "willow",
  name: "Weeping willow",
  wood: "willow",
  form: "open",
  height_m: 13,
  habit: {
    seed: 1603,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
      branch: {
        levels: 2,
        length: { 0: 16, 1: 11, 2: 6 },
        radius: { 0: 1.4, 1: 0.55, 2: 0.6 },
        sections: { 0: 7, 1: 6, 2: 4 },
        gnarliness: { 0: 0.05, 1: 0.07, 2: 0.08 },
        force: { direction: { x: 0, y: -1, z: 0 }, strength: 0.006 },
        taper: { 0: 0.4, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [7, 5, 1],
        start: 0.4,
        angle_deg: [62, 56, 52, 46, 38, 30],
        length: [9.5, 10.5, 10.5, 9.5, 7.5, 5],
        steepest: 1,
        scatter: 0.14,
      },
      {
        count: [3, 1],
        start: 0.35,
        angle_deg: [56, 50, 42],
        length: [5, 4.8, 4],
        steepest: 0.7,
        scatter: 0.2,
      },
    ],
    leader: [[0.6, 0.4], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.195,
    taper: 1.1,
    bough_radius_m: 0.082,
    tip_radius_m: 0.014,
    exponent: 0.5,
    flare: 0.35,
    flare_height_m: 0.3,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.7, 1.3] },
  twigs: {
    count: 460,
    length_m: [2.1, 2.2, 2],
    scatter: 0.35,
    radius_m: 0.0075,
    angle_deg: [70, 66, 58],
    density: [
      [0, 0, 0, 0.2, 0.5, 0.7, 0.7],
      [0, 0.6, 1, 1.2],
      [0.5, 1, 1.2],
    ],
    rise: -3.4,
    nodes: 4,
    perNode: 1,
    side_angle_deg: 24,
    side_length: 0.55,
    zigzag: 0.02,
    colour: [0.3, 0.25, 0.09],
  },
  foliage: {
    cards: 2750,
    size_m: 0.52,
    scatter: 0.25,
    angle_deg: [26, 20, 14],
    lift: -0.9,
    shade: 0.6,
    bough_tint: 0.16,
    card_tint: 0.22,
  },
  leaf: {
    ...lanceolate(),
    palettes: [
      [
        [0.42, 0.58, 0.24],
        [0.48, 0.63, 0.28],
        [0.37, 0.53, 0.22],
      ],
      [
        [0.5, 0.65, 0.3],
        [0.44, 0.6, 0.26],
        [0.55, 0.69, 0.33],
      ],
      [
        [0.39, 0.55, 0.23],
        [0.44, 0.6, 0.25],
        [0.35, 0.5, 0.21],
      ],
      [
        [0.54, 0.67, 0.31],
        [0.48, 0.61, 0.27],
        [0.58, 0.7, 0.34],
      ],
    ],
    vein: [0.66, 0.76, 0.46],
    stem: [0.5, 0.45, 0.2],
    length: 0.21,
    petiole: 0.06,
    leavesPerCard: 44,
    leavesPerSpray: 12,
    sideShoots: 4,
    fuller: { sideShoots: 6, sideLength: 1, leavesPerCard: 84 },
    sprayShoots: null,
    angle_deg: 32,
  },
  bark: furrowedBark(131, { dark: [0.16, 0.14, 0.11], light: [0.55, 0.51, 0.43] }, 8, 6, 0.95),
  barkRelief: 3.8,
};

/** Grown between other trees: a taller stem with a narrow, hanging crown. */
export const willowForest: Species = {
  ...willow,
  id: "willow-forest",
  name: "Weeping willow, forest-grown",
  form: "forest",
  height_m: 16,
  habit: {
    ...willow.habit,
    seed: 1615,
    branching: [
      {
        count: [0, 10],
        start: 1,
        angle_deg: [60, 56, 52, 46, 40, 32],
        length: [2.6, 3.2, 3.8, 3.8, 3.2, 2],
        steepest: 1,
        scatter: 0.15,
      },
      { ...willow.habit.branching[1], count: [2, 1], length: [2.2, 2, 1.7] },
    ],
    leader: [[0.9, 0.25], [0.5], []],
  },
  girth: {
    ...willow.girth,
    breast_radius_m: 0.089,
    taper: 0.85,
    bough_radius_m: 0.026,
    tip_radius_m: 0.01,
    flare: 0.3,
  },
  twigs: {
    ...willow.twigs,
    count: 240,
    length_m: [1.5, 1.5, 1.3],
    density: [
      [0, 0, 0, 0, 0.2, 0.6, 1.2],
      [0, 0.5, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
  },
  foliage: { ...willow.foliage, cards: 1450, size_m: 0.46 },
};
