import { pineBark } from "../pictures/barks";
import { needle } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Scots pine grown in the open: an irregular, domed crown of stout boughs with tufts of needles at their ends. */
export const pine: Species = {
  id: "pine",
  name: "Scots pine",
  wood: "pine",
  form: "open",
  height_m: 16,
  habit: {
    seed: 1207,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
      branch: {
        levels: 2,
        length: { 0: 34, 1: 13, 2: 5 },
        radius: { 0: 1.3, 1: 0.5, 2: 0.6 },
        sections: { 0: 10, 1: 5, 2: 3 },
        gnarliness: { 0: 0.03, 1: 0.09, 2: 0.1 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.016 },
        taper: { 0: 0.5, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [10, 7, 2],
        start: 0.35,
        angle_deg: [86, 80, 74, 66, 54, 40],
        length: [10, 11.5, 12, 11, 8, 4],
        steepest: 1,
        scatter: 0.16,
      },
      {
        count: [2, 1],
        start: 0.35,
        angle_deg: [58, 52, 44],
        length: [5, 4.8, 3.8],
        steepest: 0.8,
        scatter: 0.2,
      },
    ],
    leader: [[0.5, 0.35], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.175,
    taper: 1,
    bough_radius_m: 0.055,
    tip_radius_m: 0.0125,
    exponent: 0.5,
    flare: 0.3,
    flare_height_m: 0.3,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.7, 1.4] },
  twigs: {
    count: 450,
    length_m: [0.8, 0.75, 0.65],
    scatter: 0.3,
    radius_m: 0.0095,
    angle_deg: [60, 52, 42],
    density: [
      [0, 0, 0, 0, 0.4, 0.7, 0.8],
      [0, 0.3, 0.9, 1.3],
      [0.3, 1, 1.3],
    ],
    rise: 0.7,
    nodes: 3,
    perNode: 2,
    side_angle_deg: 50,
    side_length: 0.5,
    zigzag: 0,
    colour: [0.2, 0.12, 0.075],
  },
  foliage: {
    cards: 2700,
    size_m: 0.44,
    scatter: 0.2,
    angle_deg: [46, 36, 20],
    lift: 0.35,
    shade: 0.5,
    bough_tint: 0.14,
    card_tint: 0.18,
  },
  leaf: {
    ...needle(0.026),
    palettes: [
      [
        [0.24, 0.38, 0.2],
        [0.29, 0.43, 0.23],
        [0.2, 0.33, 0.18],
      ],
      [
        [0.27, 0.41, 0.22],
        [0.32, 0.46, 0.25],
        [0.23, 0.36, 0.2],
      ],
      [
        [0.22, 0.36, 0.2],
        [0.26, 0.4, 0.22],
        [0.19, 0.31, 0.18],
      ],
      [
        [0.31, 0.44, 0.24],
        [0.26, 0.39, 0.21],
        [0.36, 0.48, 0.27],
      ],
    ],
    vein: [0.4, 0.52, 0.36],
    stem: [0.46, 0.31, 0.19],
    length: 0.17,
    petiole: 0,
    leavesPerCard: 300,
    leavesPerSpray: 220,
    sideShoots: 6,
    fuller: { sideShoots: 9, sideLength: 1.1, leavesPerCard: 450 },
    sprayShoots: {},
    angle_deg: 34,
  },
  bark: pineBark(97),
  barkRelief: 3.4,
};

/** Grown in a closed forest: a long bare stem under a short crown. */
export const pineForest: Species = {
  ...pine,
  id: "pine-forest",
  name: "Scots pine, forest-grown",
  form: "forest",
  height_m: 20,
  habit: {
    ...pine.habit,
    seed: 1219,
    branching: [
      {
        count: [0, 15],
        start: 1,
        angle_deg: [84, 80, 74, 66, 56, 42],
        length: [4, 5.2, 6.2, 6.2, 5, 2.8],
        steepest: 1,
        scatter: 0.16,
      },
      { ...pine.habit.branching[1], count: [1, 1], length: [3, 3, 2.6] },
    ],
    leader: [[0.75, 0.25], [0.5], []],
  },
  girth: {
    ...pine.girth,
    breast_radius_m: 0.11,
    taper: 0.9,
    bough_radius_m: 0.02,
    tip_radius_m: 0.009,
  },
  twigs: {
    ...pine.twigs,
    count: 250,
    density: [
      [0, 0, 0, 0, 0, 0.4, 1.1],
      [0, 0.4, 0.9, 1.3],
      [0.3, 1, 1.3],
    ],
    length_m: [0.65, 0.6, 0.5],
  },
  foliage: { ...pine.foliage, cards: 1450, size_m: 0.42 },
};
