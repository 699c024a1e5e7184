import { apricotBark } from "./bark-picture";
import { ovate } from "./leaf-shapes";
import type { Species } from "./species";

/** A small orchard tree: short stem and wide round crown with crooked boughs. */
export const apricot: Species = {
  id: "apricot",
  name: "Apricot",
  wood: "apricot",
  height_m: 6,
  habit: {
    seed: 606,
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
        count: [7, 6, 1],
        start: 0.5,
        angle_deg: [64, 62, 60, 54, 46, 34],
        length: [11.5, 12.5, 12, 10.5, 8, 5],
        steepest: 1,
        scatter: 0.1,
      },
      {
        count: [4, 1],
        start: 0.28,
        angle_deg: [58, 50, 42],
        length: [6, 5.5, 4],
        steepest: 0.75,
        scatter: 0.22,
      },
    ],
    leader: [[0.8, 0.5], [0.5], []],
  },
  girth: {
    breast_radius_m: 0.09,
    breast_height_m: 0.7,
    tip_radius_m: 0.008,
    exponent: 0.5,
    flare: 0.3,
    flare_height_m: 0.2,
  },
  cut: { segments: [9, 5, 4], bark_tile_m: [0.55, 1.1] },
  foliage: {
    cards: 2700,
    size_m: 0.42,
    scatter: 0.25,
    angle_deg: [70, 60, 40],
    density: [
      [0, 0, 0, 0.3, 0.7, 1, 1.2],
      [0, 0.4, 0.9, 1.2],
      [0.5, 1, 1.2],
    ],
    reach_m: 0.32,
    lift: 0.08,
    shade: 0.5,
    bough_tint: 0.2,
    spray_tint: 0.25,
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
    angle_deg: 50,
  },
  bark: apricotBark(37),
  barkRelief: 3.5,
};
