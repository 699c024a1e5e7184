import { furrowedBark } from "../pictures/barks";
import { compound } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Ash grown in the open: a high, domed, open crown of ascending boughs with stout, opposite twigs. */
export const ash: Species = {
  id: "ash",
  name: "Ash",
  wood: "ash",
  form: "open",
  height_m: 17,
  habit: {
    seed: 1301,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
      branch: {
        levels: 2,
        length: { 0: 32, 1: 14, 2: 7 },
        radius: { 0: 1.4, 1: 0.5, 2: 0.6 },
        sections: { 0: 9, 1: 5, 2: 3 },
        gnarliness: { 0: 0.03, 1: 0.06, 2: 0.08 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.022 },
        taper: { 0: 0.5, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [12, 5, 1],
        start: 0.28,
        angle_deg: [64, 58, 52, 46, 38, 28],
        length: [12, 13.5, 13.5, 12, 9, 4.6],
        steepest: 1,
        scatter: 0.14,
      },
      {
        count: [3, 1],
        start: 0.35,
        angle_deg: [54, 48, 40],
        length: [6.6, 6, 4.6],
        steepest: 0.8,
        scatter: 0.2,
      },
    ],
    leader: [[0.5, 0.36], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.168,
    taper: 1.4,
    bough_radius_m: 0.068,
    tip_radius_m: 0.0125,
    exponent: 0.5,
    flare: 0.35,
    flare_height_m: 0.3,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.7, 1.4] },
  twigs: {
    count: 420,
    length_m: [1.2, 1.1, 0.95],
    scatter: 0.35,
    radius_m: 0.0105,
    angle_deg: [56, 50, 42],
    density: [
      [0, 0, 0, 0, 0.4, 0.7, 0.7],
      [0, 0.5, 0.9, 1.2],
      [0.4, 1, 1.2],
    ],
    rise: 0.6,
    nodes: 3,
    perNode: 2,
    side_angle_deg: 48,
    side_length: 0.45,
    zigzag: 0.02,
    colour: [0.2, 0.19, 0.16],
  },
  foliage: {
    cards: 2500,
    size_m: 0.6,
    scatter: 0.25,
    angle_deg: [56, 46, 30],
    lift: 0.05,
    shade: 0.6,
    bough_tint: 0.2,
    card_tint: 0.24,
  },
  leaf: {
    ...compound(),
    palettes: [
      [
        [0.36, 0.54, 0.19],
        [0.42, 0.6, 0.22],
        [0.31, 0.48, 0.17],
      ],
      [
        [0.44, 0.61, 0.24],
        [0.38, 0.56, 0.2],
        [0.49, 0.65, 0.27],
      ],
      [
        [0.33, 0.5, 0.18],
        [0.38, 0.56, 0.2],
        [0.29, 0.45, 0.16],
      ],
      [
        [0.48, 0.63, 0.25],
        [0.42, 0.57, 0.21],
        [0.53, 0.66, 0.28],
      ],
    ],
    vein: [0.58, 0.7, 0.36],
    stem: [0.3, 0.29, 0.2],
    length: 0.28,
    petiole: 0.1,
    leavesPerCard: 22,
    leavesPerSpray: 5,
    sideShoots: 4,
    fuller: { sideShoots: 8, sideLength: 1.1, leavesPerCard: 60 },
    sprayShoots: null,
    angle_deg: 52,
  },
  bark: furrowedBark(103, { dark: [0.2, 0.18, 0.15], light: [0.62, 0.59, 0.52] }, 9, 6, 0.8),
  barkRelief: 3.2,
};

/** Grown in a closed forest: a long straight stem with an open crown. */
export const ashForest: Species = {
  ...ash,
  id: "ash-forest",
  name: "Ash, forest-grown",
  form: "forest",
  height_m: 21,
  habit: {
    ...ash.habit,
    seed: 1312,
    branching: [
      {
        count: [0, 11],
        start: 1,
        angle_deg: [64, 60, 54, 48, 40, 30],
        length: [5, 6.5, 8, 8.4, 7, 4],
        steepest: 1,
        scatter: 0.15,
      },
      { ...ash.habit.branching[1], count: [2, 1], length: [4.6, 4.2, 3.4] },
    ],
    leader: [[0.95, 0.22], [0.5], []],
  },
  girth: {
    ...ash.girth,
    breast_radius_m: 0.115,
    taper: 1.05,
    bough_radius_m: 0.029,
    tip_radius_m: 0.01,
    flare: 0.3,
  },
  twigs: {
    ...ash.twigs,
    count: 230,
    density: [
      [0, 0, 0, 0, 0.2, 0.7, 1.2],
      [0, 0.5, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    length_m: [0.95, 0.9, 0.75],
  },
  foliage: { ...ash.foliage, cards: 1450, size_m: 0.54 },
};
