import { birchBark } from "../pictures/barks";
import { rhombic } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Silver birch grown in the open: a slender crown of ascending boughs with hanging twigs. */
export const birch: Species = {
  id: "birch",
  name: "Silver birch",
  wood: "birch",
  form: "open",
  height_m: 17,
  habit: {
    seed: 811,
    options: {
      type: "deciduous",
      trellis: { enabled: false },
      branch: {
        levels: 2,
        length: { 0: 45, 1: 15, 2: 6 },
        radius: { 0: 1.1, 1: 0.5, 2: 0.7 },
        sections: { 0: 12, 1: 5, 2: 3 },
        gnarliness: { 0: 0.035, 1: 0.06, 2: 0.08 },
        force: { direction: { x: 0, y: 1, z: 0 }, strength: 0.008 },
        taper: { 0: 0.5, 1: 0.5, 2: 0.6 },
      },
    },
    branching: [
      {
        count: [17, 6, 2],
        start: 0.2,
        angle_deg: [62, 58, 52, 46, 40, 32],
        length: [11, 13, 13, 11.5, 8.5, 4.5],
        steepest: 1,
        scatter: 0.12,
      },
      {
        count: [1, 1],
        start: 0.35,
        angle_deg: [52, 46, 40],
        length: [5.5, 5, 3.6],
        steepest: 0.8,
        scatter: 0.2,
      },
    ],
    leader: [[0.36, 0.42], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.15,
    taper: 1.3,
    bough_radius_m: 0.055,
    tip_radius_m: 0.0105,
    exponent: 0.5,
    flare: 0.35,
    flare_height_m: 0.25,
  },
  cut: { segments: [8, 5, 4], bark_tile_m: [0.7, 1.5] },
  twigs: {
    count: 450,
    length_m: [1.3, 1.35, 1.2],
    scatter: 0.35,
    radius_m: 0.0085,
    angle_deg: [58, 54, 48],
    density: [
      [0, 0, 0, 0.1, 0.4, 0.7, 0.7],
      [0.1, 0.7, 1, 1.1],
      [0.5, 1, 1.1],
    ],
    rise: -1.5,
    nodes: 4,
    perNode: 1,
    side_angle_deg: 38,
    side_length: 0.55,
    zigzag: 0.06,
    colour: [0.1, 0.06, 0.05],
  },
  foliage: {
    cards: 2700,
    size_m: 0.46,
    scatter: 0.25,
    angle_deg: [48, 40, 26],
    lift: -0.35,
    shade: 0.62,
    bough_tint: 0.2,
    card_tint: 0.3,
  },
  leaf: {
    ...rhombic(),
    palettes: [
      [
        [0.42, 0.6, 0.2],
        [0.48, 0.66, 0.24],
        [0.37, 0.54, 0.18],
      ],
      [
        [0.5, 0.68, 0.26],
        [0.44, 0.62, 0.22],
        [0.56, 0.72, 0.3],
      ],
      [
        [0.38, 0.56, 0.19],
        [0.44, 0.62, 0.22],
        [0.34, 0.5, 0.17],
      ],
      [
        [0.55, 0.7, 0.27],
        [0.48, 0.64, 0.24],
        [0.6, 0.72, 0.3],
      ],
    ],
    vein: [0.66, 0.78, 0.42],
    stem: [0.32, 0.2, 0.14],
    length: 0.135,
    petiole: 0.42,
    leavesPerCard: 34,
    leavesPerSpray: 9,
    sideShoots: 4,
    fuller: { sideShoots: 6, sideLength: 1.05, leavesPerCard: 84 },
    sprayShoots: null,
    angle_deg: 50,
  },
  bark: birchBark(53),
  barkRelief: 2.4,
};

/** Grown in a closed forest: a long bare stem with a narrow crown. */
export const birchForest: Species = {
  ...birch,
  id: "birch-forest",
  name: "Silver birch, forest-grown",
  form: "forest",
  height_m: 20,
  habit: {
    ...birch.habit,
    seed: 823,
    branching: [
      {
        count: [0, 14],
        start: 1,
        angle_deg: [70, 66, 60, 54, 46, 36],
        length: [5, 6.5, 8.5, 9.5, 8, 4.5],
        steepest: 1,
        scatter: 0.15,
      },
      birch.habit.branching[1],
    ],
    leader: [[0.95, 0.22], [0.45], []],
  },
  girth: {
    ...birch.girth,
    breast_radius_m: 0.108,
    taper: 0.9,
    bough_radius_m: 0.03,
    tip_radius_m: 0.0095,
    flare: 0.3,
  },
  twigs: {
    ...birch.twigs,
    count: 260,
    density: [
      [0, 0, 0, 0, 0, 0.5, 1.2],
      [0.1, 0.7, 1, 1.1],
      [0.5, 1, 1.1],
    ],
    length_m: [1, 1, 0.85],
  },
  foliage: { ...birch.foliage, cards: 1500, size_m: 0.44 },
};
