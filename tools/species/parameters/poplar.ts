import { TreePreset } from "../growth/ez-tree";
import { poplarBark } from "../pictures/barks";
import { deltoid } from "../pictures/leaf-shapes";
import type { Species } from "../species";

/** Grown in the open: crown almost to the ground, narrow, ascending boughs; based on the generator's aspen. */
export const poplar: Species = {
  id: "poplar",
  name: "Poplar",
  wood: "poplar",
  form: "open",
  height_m: 19,
  habit: {
    seed: 303,
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
        count: [20, 6, 2],
        start: 0.2,
        angle_deg: [66, 64, 58, 50, 42, 34],
        length: [12.5, 14, 14.5, 13, 10, 5],
        steepest: 1,
        scatter: 0.1,
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
    breast_radius_m: 0.172,
    taper: 1.25,
    bough_radius_m: 0.07,
    tip_radius_m: 0.011,
    exponent: 0.5,
    flare: 0.35,
    flare_height_m: 0.25,
  },
  cut: { segments: [8, 5, 4], bark_tile_m: [0.7, 1.6] },
  twigs: {
    count: 460,
    length_m: [1.3, 1.2, 1],
    scatter: 0.35,
    radius_m: 0.0115,
    angle_deg: [52, 46, 38],
    density: [
      [0, 0, 0, 0.1, 0.4, 0.7, 0.7],
      [0.1, 0.7, 1, 1.1],
      [0.5, 1, 1.1],
    ],
    rise: 0.55,
    nodes: 4,
    perNode: 1,
    side_angle_deg: 48,
    side_length: 0.5,
    zigzag: 0.1,
    colour: [0.23, 0.2, 0.13],
  },
  foliage: {
    cards: 2700,
    size_m: 0.52,
    scatter: 0.25,
    angle_deg: [55, 45, 30],
    lift: 0.1,
    shade: 0.55,
    bough_tint: 0.25,
    card_tint: 0.3,
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
    leavesPerSpray: 6,
    sideShoots: 4,
    sprayShoots: null,
    angle_deg: 52,
  },
  bark: poplarBark(11),
  barkRelief: 2.2,
};

/** Grown in a closed forest: a clean slender stem with a short crown. */
export const poplarForest: Species = {
  ...poplar,
  id: "poplar-forest",
  name: "Poplar, forest-grown",
  form: "forest",
  height_m: 19,
  habit: {
    ...poplar.habit,
    seed: 320,
    branching: [
      {
        count: [0, 14],
        start: 1,
        angle_deg: [80, 74, 66, 60, 50, 38],
        length: [6, 7.5, 10, 11.5, 9.5, 5.5],
        steepest: 1,
        scatter: 0.15,
      },
      poplar.habit.branching[1],
    ],
    leader: [[0.95, 0.22], [0.45], []],
  },
  girth: {
    ...poplar.girth,
    breast_radius_m: 0.104,
    taper: 0.85,
    bough_radius_m: 0.035,
    tip_radius_m: 0.01,
    flare: 0.3,
  },
  twigs: {
    ...poplar.twigs,
    count: 260,
    density: [
      [0, 0, 0, 0, 0, 0.5, 1.2],
      [0.1, 0.7, 1, 1.1],
      [0.5, 1, 1.1],
    ],
    length_m: [0.95, 0.9, 0.75],
  },
  foliage: { ...poplar.foliage, cards: 1500, size_m: 0.5 },
};
