import { beechBark } from "../pictures/barks";
import { elliptic } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Beech grown in the open: a dense, domed crown down to the ground. */
export const beech: Species = {
  id: "beech",
  name: "Beech",
  wood: "beech",
  form: "open",
  height_m: 18,
  habit: {
    seed: 1013,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
      branch: {
        levels: 2,
        length: { 0: 32, 1: 14, 2: 7 },
        radius: { 0: 1.4, 1: 0.5, 2: 0.6 },
        sections: { 0: 9, 1: 5, 2: 3 },
        gnarliness: { 0: 0.03, 1: 0.05, 2: 0.07 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.012 },
        taper: { 0: 0.5, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [13, 5, 1],
        start: 0.2,
        angle_deg: [72, 66, 58, 50, 40, 30],
        length: [13, 14.5, 14.5, 12.6, 9.2, 4.6],
        steepest: 1,
        scatter: 0.12,
      },
      {
        count: [3, 1],
        start: 0.3,
        angle_deg: [54, 48, 40],
        length: [7, 6.4, 5],
        steepest: 0.7,
        scatter: 0.2,
      },
    ],
    leader: [[0.48, 0.36], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.19,
    taper: 1.4,
    bough_radius_m: 0.085,
    tip_radius_m: 0.0145,
    exponent: 0.5,
    flare: 0.45,
    flare_height_m: 0.35,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.8, 1.6] },
  twigs: {
    count: 450,
    length_m: [1.4, 1.3, 1.1],
    scatter: 0.3,
    radius_m: 0.011,
    angle_deg: [58, 50, 42],
    density: [
      [0, 0, 0, 0.2, 0.5, 0.7, 0.7],
      [0.1, 0.6, 1, 1.2],
      [0.4, 1, 1.2],
    ],
    rise: 0.15,
    nodes: 4,
    perNode: 1,
    side_angle_deg: 50,
    side_length: 0.55,
    zigzag: 0.12,
    colour: [0.16, 0.13, 0.115],
  },
  foliage: {
    cards: 2700,
    size_m: 0.6,
    scatter: 0.25,
    angle_deg: [56, 46, 30],
    lift: 0.02,
    shade: 0.5,
    bough_tint: 0.2,
    card_tint: 0.22,
  },
  leaf: {
    ...elliptic(),
    palettes: [
      [
        [0.28, 0.5, 0.15],
        [0.34, 0.56, 0.18],
        [0.24, 0.44, 0.13],
      ],
      [
        [0.38, 0.58, 0.2],
        [0.32, 0.52, 0.17],
        [0.43, 0.62, 0.22],
      ],
      [
        [0.26, 0.46, 0.14],
        [0.31, 0.52, 0.16],
        [0.22, 0.41, 0.13],
      ],
      [
        [0.42, 0.6, 0.2],
        [0.36, 0.54, 0.17],
        [0.46, 0.62, 0.22],
      ],
    ],
    vein: [0.58, 0.72, 0.36],
    stem: [0.36, 0.25, 0.17],
    length: 0.17,
    petiole: 0.12,
    leavesPerCard: 30,
    leavesPerSpray: 8,
    sideShoots: 4,
    fuller: { sideShoots: 6, sideLength: 1, leavesPerCard: 44 },
    sprayShoots: null,
    angle_deg: 52,
  },
  bark: beechBark(71),
  barkRelief: 1,
};

/** Grown in a closed forest: a tall smooth stem with a high crown. */
export const beechForest: Species = {
  ...beech,
  id: "beech-forest",
  name: "Beech, forest-grown",
  form: "forest",
  height_m: 22,
  habit: {
    ...beech.habit,
    seed: 1024,
    branching: [
      {
        count: [0, 12],
        start: 1,
        angle_deg: [68, 62, 56, 48, 40, 30],
        length: [5.5, 7, 8.5, 8.5, 6.8, 4],
        steepest: 1,
        scatter: 0.15,
      },
      { ...beech.habit.branching[1], count: [2, 1], length: [4.6, 4.2, 3.5] },
    ],
    leader: [[0.95, 0.22], [0.5], []],
  },
  girth: {
    ...beech.girth,
    breast_radius_m: 0.125,
    taper: 0.9,
    bough_radius_m: 0.036,
    tip_radius_m: 0.012,
    flare: 0.3,
  },
  twigs: {
    ...beech.twigs,
    count: 240,
    density: [
      [0, 0, 0, 0, 0.2, 0.7, 1.2],
      [0, 0.5, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    length_m: [1.05, 1, 0.85],
  },
  foliage: { ...beech.foliage, cards: 1500, size_m: 0.54 },
};
