import { scalyBark } from "../pictures/barks";
import { needle } from "../pictures/leaf-shapes";
import type { Species } from "../species";
import { spruce, spruceForest } from "./spruce";

/** European larch, which sheds its needles, grown in the open: an airy cone with hanging branchlets. */
export const larch: Species = {
  ...spruce,
  id: "larch",
  name: "European larch",
  wood: "larch",
  habit: {
    ...spruce.habit,
    seed: 1507,
    branching: [
      {
        count: [29, 15, 5],
        start: 0.14,
        angle_deg: [94, 90, 86, 78, 68, 54],
        length: [11.5, 12, 11, 8.8, 6, 2.4],
        steepest: 1,
        scatter: 0.14,
      },
    ],
    leader: [[0.5, 0.3], [0.5], []],
  },
  girth: {
    ...spruce.girth,
    breast_radius_m: 0.163,
    taper: 1.25,
    bough_radius_m: 0.027,
    tip_radius_m: 0.0085,
  },
  twigs: {
    ...spruce.twigs,
    count: 430,
    length_m: [1, 0.9, 0.6],
    density: [
      [0, 0, 0, 0, 0.2, 0.5, 1.1],
      [0.5, 1, 1.1, 1],
    ],
    rise: -1,
    side_angle_deg: 52,
    side_length: 0.45,
    colour: [0.26, 0.18, 0.1],
  },
  foliage: {
    ...spruce.foliage,
    cards: 2500,
    size_m: 0.5,
    angle_deg: [52, 42, 22],
    shade: 0.6,
    lift: -0.4,
    bough_tint: 0.14,
    card_tint: 0.2,
  },
  leaf: {
    ...spruce.leaf,
    ...needle(0.05),
    palettes: [
      [
        [0.4, 0.58, 0.22],
        [0.46, 0.63, 0.26],
        [0.36, 0.53, 0.2],
      ],
      [
        [0.46, 0.63, 0.26],
        [0.41, 0.58, 0.23],
        [0.51, 0.67, 0.29],
      ],
      [
        [0.37, 0.55, 0.21],
        [0.42, 0.6, 0.23],
        [0.34, 0.5, 0.19],
      ],
      [
        [0.5, 0.66, 0.28],
        [0.44, 0.6, 0.24],
        [0.55, 0.69, 0.31],
      ],
    ],
    vein: [0.6, 0.74, 0.42],
    stem: [0.52, 0.38, 0.22],
    length: 0.075,
    leavesPerCard: 460,
    leavesPerSpray: 300,
    sideShoots: 6,
    fuller: { sideShoots: 20, sideLength: 1.3, leavesPerCard: 3200 },
    sprayShoots: {},
    angle_deg: 62,
  },
  bark: scalyBark(127, { dark: [0.2, 0.12, 0.09], light: [0.56, 0.4, 0.31] }, 8, 9),
  barkRelief: 3.4,
};

/** Grown in a closed forest: a slender stem with a narrow crown on its upper half. */
export const larchForest: Species = {
  ...spruceForest,
  id: "larch-forest",
  name: "European larch, forest-grown",
  wood: "larch",
  habit: {
    ...spruceForest.habit,
    seed: 1519,
    branching: [
      {
        count: [0, 26, 14],
        start: 1,
        angle_deg: [96, 95, 92, 86, 76, 60],
        length: [5, 6, 6.6, 5.8, 4, 1.8],
        steepest: 1,
        scatter: 0.1,
      },
    ],
    leader: [[0.6, 0.5], [0.5], []],
  },
  girth: {
    ...spruceForest.girth,
    breast_radius_m: 0.123,
    taper: 1.1,
    bough_radius_m: 0.015,
    tip_radius_m: 0.0078,
  },
  twigs: {
    ...spruceForest.twigs,
    count: 260,
    length_m: [0.72, 0.66, 0.48],
    density: [
      [0, 0, 0, 0, 0, 0.4, 1.6],
      [0.4, 1, 1.1, 1],
    ],
    rise: larch.twigs.rise,
    side_angle_deg: larch.twigs.side_angle_deg,
    colour: larch.twigs.colour,
  },
  foliage: { ...larch.foliage, cards: 1500, size_m: 0.46 },
  leaf: larch.leaf,
  bark: larch.bark,
  barkRelief: larch.barkRelief,
};
