import { mapleBark } from "../pictures/barks";
import { palmate } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Grown in the open: broad oval crown with boughs in layers; red in autumn. */
export const maple: Species = {
  id: "maple",
  name: "Maple",
  wood: "maple",
  form: "open",
  height_m: 17,
  habit: {
    seed: 707,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
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
        length: [12.5, 14, 13.6, 12, 9, 4.5],
        steepest: 1,
        scatter: 0.14,
      },
      {
        count: [3, 1],
        start: 0.3,
        angle_deg: [60, 52, 42],
        length: [7, 6.4, 5],
        steepest: 0.75,
        scatter: 0.2,
      },
    ],
    leader: [[0.48, 0.36], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.169,
    taper: 1.27,
    bough_radius_m: 0.085,
    tip_radius_m: 0.0155,
    exponent: 0.5,
    flare: 0.4,
    flare_height_m: 0.3,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.7, 1.4] },
  twigs: {
    count: 450,
    length_m: [1.4, 1.3, 1.1],
    scatter: 0.35,
    radius_m: 0.0115,
    angle_deg: [58, 50, 42],
    density: [
      [0, 0, 0, 0, 0.4, 0.7, 0.7],
      [0, 0.5, 0.9, 1.2],
      [0.4, 1, 1.2],
    ],
    rise: 0.35,
    nodes: 3,
    perNode: 2,
    side_angle_deg: 46,
    side_length: 0.5,
    zigzag: 0.03,
    colour: [0.16, 0.12, 0.1],
  },
  foliage: {
    cards: 2700,
    size_m: 0.6,
    scatter: 0.25,
    angle_deg: [60, 50, 35],
    lift: -0.02,
    shade: 0.5,
    bough_tint: 0.35,
    card_tint: 0.25,
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
    leavesPerSpray: 6,
    sideShoots: 4,
    sprayShoots: null,
    angle_deg: 55,
  },
  bark: mapleBark(23),
  barkRelief: 4,
};

/** Grown in a closed forest: a clean slender stem with a short crown. */
export const mapleForest: Species = {
  ...maple,
  id: "maple-forest",
  name: "Maple, forest-grown",
  form: "forest",
  height_m: 19,
  habit: {
    ...maple.habit,
    seed: 711,
    branching: [
      {
        count: [0, 12],
        start: 1,
        angle_deg: [72, 68, 62, 56, 44, 30],
        length: [7, 8, 9.5, 10.5, 9, 5.5],
        steepest: 1,
        scatter: 0.16,
      },
      { ...maple.habit.branching[1], length: [7, 6.5, 5] },
    ],
    leader: [[0.95, 0.25], [0.5], []],
  },
  girth: {
    ...maple.girth,
    breast_radius_m: 0.103,
    taper: 0.85,
    bough_radius_m: 0.03,
    tip_radius_m: 0.0105,
    flare: 0.35,
  },
  twigs: {
    ...maple.twigs,
    count: 220,
    density: [
      [0, 0, 0, 0, 0, 0.5, 1.2],
      [0, 0.5, 0.9, 1.2],
      [0.4, 1, 1.2],
    ],
    length_m: [1.1, 1, 0.85],
  },
  foliage: { ...maple.foliage, cards: 1500, size_m: 0.5 },
};
