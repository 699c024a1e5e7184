import { scalyBark } from "../pictures/barks";
import { broadPalmate } from "../pictures/leaf-shapes";
import type { Species } from "../species";
import { maple, mapleForest } from "./maple";

/** Sycamore, a maple, grown in the open: a broad, dense dome. */
export const sycamore: Species = {
  ...maple,
  id: "sycamore",
  name: "Sycamore",
  wood: "sycamore",
  height_m: 17.5,
  habit: {
    ...maple.habit,
    seed: 1409,
    branching: [
      {
        ...maple.habit.branching[0],
        count: [13, 5, 1],
        start: 0.22,
        angle_deg: [76, 70, 62, 52, 42, 30],
        length: [13.5, 15, 14.6, 12.8, 9.4, 4.6],
      },
      maple.habit.branching[1],
    ],
  },
  girth: {
    ...maple.girth,
    breast_radius_m: 0.18,
    taper: 1.4,
    bough_radius_m: 0.076,
    tip_radius_m: 0.0125,
    flare: 0.4,
  },
  twigs: { ...maple.twigs, colour: [0.19, 0.16, 0.13] },
  foliage: { ...maple.foliage, size_m: 0.6 },
  leaf: {
    ...maple.leaf,
    ...broadPalmate(),
    palettes: [
      [
        [0.29, 0.47, 0.17],
        [0.35, 0.53, 0.2],
        [0.25, 0.41, 0.15],
      ],
      [
        [0.37, 0.55, 0.22],
        [0.31, 0.49, 0.18],
        [0.42, 0.58, 0.24],
      ],
      [
        [0.26, 0.43, 0.16],
        [0.31, 0.49, 0.18],
        [0.23, 0.39, 0.14],
      ],
      [
        [0.41, 0.57, 0.22],
        [0.35, 0.51, 0.19],
        [0.46, 0.6, 0.25],
      ],
    ],
    length: 0.185,
    fuller: { sideShoots: 6, sideLength: 1.05, leavesPerCard: 30 },
    vein: [0.6, 0.7, 0.4],
    stem: [0.45, 0.24, 0.18],
  },
  bark: scalyBark(113, { dark: [0.3, 0.26, 0.23], light: [0.66, 0.61, 0.55] }, 7, 9),
  barkRelief: 2,
};

/** Grown in a closed forest. */
export const sycamoreForest: Species = {
  ...mapleForest,
  id: "sycamore-forest",
  name: "Sycamore, forest-grown",
  wood: "sycamore",
  height_m: 20,
  habit: { ...mapleForest.habit, seed: 1421 },
  girth: { ...mapleForest.girth, breast_radius_m: 0.11 },
  twigs: { ...mapleForest.twigs, colour: sycamore.twigs.colour },
  leaf: sycamore.leaf,
  bark: sycamore.bark,
  barkRelief: sycamore.barkRelief,
};
