/** Places in the clearing in front of the first view, for trees that are shown singly. Pure. */

import type { Placement } from "galewood/trees";
import { gladeCentre_m } from "./ground/landscape";

/** Ids of the places of the forest are smaller (placement.ts). */
const FIRST_ID = 2 ** 24;
/** Along the glade (z) and across it (from its centre line), m: the first ones stand in the middle of the first view. */
const SPOTS = [
  [-6, 1],
  [7, -5],
  [-19, 0],
  [5, 5],
  [-32, -1],
  [-13, -3],
] as const;
/** Distance of all further places, along the glade. */
const FURTHER_M = 11;

/** The k-th place of the clearing. A tree stands there at its own size. */
export function clearingPlace(k: number): Placement {
  const [z_m, across_m] = SPOTS[k] ?? [-32 - FURTHER_M * (k - SPOTS.length + 1), 0];
  return { id: FIRST_ID + k, x_m: gladeCentre_m(z_m) + across_m, z_m, yaw_rad: 0, scale: 1 };
}
