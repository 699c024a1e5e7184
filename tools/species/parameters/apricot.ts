import { apricotBark } from "../pictures/barks";
import { ovate } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Grown in the open: short stem and wide round crown with crooked boughs. */
export const apricot: Species = {
  id: "apricot",
  name: "Apricot",
  wood: "apricot",
  form: "open",
  height_m: 10.5,
  habit: {
    seed: 642,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
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
        count: [5, 5, 1],
        start: 0.6,
        angle_deg: [64, 62, 60, 54, 46, 34],
        length: [8, 9, 9.4, 8.7, 7.2, 5],
        steepest: 1,
        scatter: 0.1,
      },
      {
        count: [4, 1],
        start: 0.28,
        angle_deg: [58, 50, 42],
        length: [4.2, 4, 3.2],
        steepest: 0.75,
        scatter: 0.22,
      },
    ],
    leader: [[0.85, 0.3], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.1505,
    taper: 1.08,
    bough_radius_m: 0.072,
    tip_radius_m: 0.012,
    exponent: 0.5,
    flare: 0.2,
    flare_height_m: 0.2,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.55, 1.1] },
  twigs: {
    count: 450,
    length_m: [0.95, 0.9, 0.75],
    scatter: 0.4,
    radius_m: 0.0095,
    angle_deg: [62, 54, 44],
    density: [
      [0, 0, 0, 0.3, 0.6, 0.7, 0.7],
      [0, 0.5, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    rise: 0.5,
    nodes: 4,
    perNode: 1,
    side_angle_deg: 58,
    side_length: 0.42,
    zigzag: 0.16,
    colour: [0.16, 0.075, 0.05],
  },
  foliage: {
    cards: 2700,
    size_m: 0.5,
    scatter: 0.25,
    angle_deg: [55, 45, 30],
    lift: 0.08,
    shade: 0.5,
    bough_tint: 0.2,
    card_tint: 0.25,
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
    leavesPerSpray: 6,
    sideShoots: 4,
    fuller: { sideShoots: 5, sideLength: 1, leavesPerCard: 34 },
    sprayShoots: null,
    angle_deg: 50,
  },
  bark: apricotBark(37),
  barkRelief: 3.5,
};

/** Grown in a closed wood: a slender stem with a short, irregular crown. */
export const apricotForest: Species = {
  ...apricot,
  id: "apricot-forest",
  name: "Apricot, forest-grown",
  form: "forest",
  height_m: 12,
  habit: {
    ...apricot.habit,
    seed: 620,
    branching: [
      {
        count: [0, 8],
        start: 1,
        angle_deg: [70, 66, 60, 54, 46, 34],
        length: [2.2, 3, 3.5, 3.6, 3.2, 2.2],
        steepest: 1,
        scatter: 0.16,
      },
      { ...apricot.habit.branching[1], count: [2, 1], length: [2, 2, 1.8] },
    ],
    leader: [[0.95, 0.25], [0.5], []],
  },
  girth: {
    ...apricot.girth,
    breast_radius_m: 0.065,
    taper: 1.35,
    bough_radius_m: 0.015,
    tip_radius_m: 0.008,
    flare: 0.25,
  },
  twigs: {
    ...apricot.twigs,
    count: 200,
    radius_m: 0.0075,
    density: [
      [0, 0, 0, 0, 0.2, 0.7, 1.2],
      [0, 0.5, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    length_m: [0.7, 0.65, 0.55],
  },
  foliage: { ...apricot.foliage, cards: 1100, size_m: 0.36 },
};
