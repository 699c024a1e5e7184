/** Parameters of the four seasons. Pure. */
import type { Rgb } from "../sky/atmosphere";

export const SEASONS = ["spring", "summer", "autumn", "winter"] as const;
export type Season = (typeof SEASONS)[number];

export interface SeasonLook {
  /** Declination of the sun, which determines its elevation. */
  readonly declination_deg: number;
  /** 1 is clean air. */
  readonly haziness: number;
  /** Cloud cover in a light wind, 0 to 1. */
  readonly clouds: number;
  readonly snow: number;
  /** Ground mist in the early morning. */
  readonly mist: number;
  /** Linear colour factors of the painted grass and litter. */
  readonly grass: Rgb;
  readonly litter: Rgb;
  /** Cover of the ground with fallen leaves, 0 to 1. */
  readonly fallen: number;
  /** Forests towards the horizon: the colours of their crowns; half of these have the first. */
  readonly woods: readonly [Rgb, Rgb, Rgb];
}

export const SEASON_LOOKS: Record<Season, SeasonLook> = {
  spring: {
    declination_deg: 8,
    haziness: 1.5,
    clouds: 0.34,
    snow: 0,
    mist: 0.8,
    grass: [0.62, 1.12, 0.5],
    litter: [0.5, 0.7, 0.9],
    fallen: 0.1,
    woods: [
      [0.15, 0.26, 0.05],
      [0.23, 0.31, 0.07],
      [0.1, 0.19, 0.04],
    ],
  },
  summer: {
    declination_deg: 20,
    haziness: 1.9,
    clouds: 0.26,
    snow: 0,
    mist: 0.6,
    grass: [0.52, 0.8, 0.42],
    litter: [0.45, 0.62, 0.75],
    fallen: 0.06,
    woods: [
      [0.06, 0.13, 0.03],
      [0.1, 0.17, 0.04],
      [0.04, 0.1, 0.025],
    ],
  },
  autumn: {
    declination_deg: -7,
    haziness: 1.7,
    clouds: 0.3,
    snow: 0,
    mist: 1,
    grass: [0.8, 0.86, 0.6],
    litter: [0.92, 1.04, 0.95],
    fallen: 1,
    woods: [
      [0.3, 0.2, 0.04],
      [0.26, 0.085, 0.03],
      [0.11, 0.125, 0.04],
    ],
  },
  winter: {
    declination_deg: -18,
    haziness: 1.3,
    clouds: 0.4,
    snow: 1,
    mist: 0.7,
    grass: [0.9, 0.8, 0.62],
    litter: [0.42, 0.4, 0.38],
    fallen: 0.5,
    woods: [
      [0.16, 0.13, 0.11],
      [0.21, 0.17, 0.14],
      [0.11, 0.1, 0.09],
    ],
  },
};
