import { furrowedBark } from "../pictures/barks";
import { lobed } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** English oak grown in the open: a short thick stem and a wide crown of crooked boughs. */
export const oak: Species = {
  id: "oak",
  name: "English oak",
  wood: "oak",
  form: "open",
  height_m: 16,
  habit: {
    seed: 918,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
      branch: {
        levels: 2,
        length: { 0: 24, 1: 15, 2: 7 },
        radius: { 0: 1.5, 1: 0.55, 2: 0.6 },
        sections: { 0: 8, 1: 6, 2: 3 },
        gnarliness: { 0: 0.06, 1: 0.12, 2: 0.13 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.01 },
        taper: { 0: 0.4, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [8, 5, 1],
        start: 0.3,
        angle_deg: [78, 72, 64, 54, 42, 30],
        length: [11.2, 13, 13.4, 12, 9.6, 5.4],
        steepest: 1,
        scatter: 0.14,
      },
      {
        count: [4, 1],
        start: 0.3,
        angle_deg: [62, 54, 44],
        length: [6, 5.8, 4.4],
        steepest: 0.75,
        scatter: 0.22,
      },
    ],
    leader: [[0.55, 0.4], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.212,
    taper: 1.5,
    bough_radius_m: 0.11,
    tip_radius_m: 0.0155,
    exponent: 0.5,
    flare: 0.45,
    flare_height_m: 0.35,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.7, 1.3] },
  twigs: {
    count: 450,
    length_m: [1.25, 1.15, 1],
    scatter: 0.4,
    radius_m: 0.0115,
    angle_deg: [62, 54, 44],
    density: [
      [0, 0, 0, 0.3, 0.6, 0.7, 0.7],
      [0, 0.5, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    rise: 0.3,
    nodes: 4,
    perNode: 1,
    side_angle_deg: 56,
    side_length: 0.5,
    zigzag: 0.18,
    colour: [0.15, 0.12, 0.095],
  },
  foliage: {
    cards: 2700,
    size_m: 0.58,
    scatter: 0.25,
    angle_deg: [58, 48, 32],
    lift: 0.1,
    shade: 0.5,
    bough_tint: 0.22,
    card_tint: 0.25,
  },
  leaf: {
    ...lobed(),
    palettes: [
      [
        [0.3, 0.48, 0.15],
        [0.36, 0.54, 0.18],
        [0.26, 0.42, 0.13],
      ],
      [
        [0.38, 0.56, 0.2],
        [0.33, 0.5, 0.17],
        [0.43, 0.6, 0.22],
      ],
      [
        [0.27, 0.44, 0.14],
        [0.32, 0.5, 0.16],
        [0.24, 0.4, 0.13],
      ],
      [
        [0.42, 0.58, 0.2],
        [0.36, 0.52, 0.17],
        [0.47, 0.6, 0.22],
      ],
    ],
    vein: [0.6, 0.7, 0.36],
    stem: [0.34, 0.25, 0.17],
    length: 0.21,
    petiole: 0.06,
    leavesPerCard: 26,
    leavesPerSpray: 7,
    sideShoots: 4,
    sprayShoots: null,
    angle_deg: 46,
  },
  bark: furrowedBark(61, { dark: [0.12, 0.1, 0.085], light: [0.52, 0.48, 0.42] }, 8, 4, 1),
  barkRelief: 4,
};

/** Grown in a closed forest: a straight stem with a short, irregular crown. */
export const oakForest: Species = {
  ...oak,
  id: "oak-forest",
  name: "English oak, forest-grown",
  form: "forest",
  height_m: 20,
  habit: {
    ...oak.habit,
    seed: 915,
    branching: [
      {
        count: [0, 11],
        start: 1,
        angle_deg: [72, 68, 62, 54, 44, 32],
        length: [5, 6.5, 8.5, 9, 7.5, 4.5],
        steepest: 1,
        scatter: 0.16,
      },
      { ...oak.habit.branching[1], count: [2, 1], length: [5, 4.6, 3.8] },
    ],
    leader: [[0.95, 0.22], [0.5], []],
  },
  girth: {
    ...oak.girth,
    breast_radius_m: 0.114,
    taper: 0.9,
    bough_radius_m: 0.038,
    tip_radius_m: 0.0125,
    flare: 0.3,
  },
  twigs: {
    ...oak.twigs,
    count: 240,
    density: [
      [0, 0, 0, 0, 0.2, 0.7, 1.2],
      [0, 0.5, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    length_m: [1, 0.95, 0.8],
  },
  foliage: { ...oak.foliage, cards: 1500, size_m: 0.52 },
};
