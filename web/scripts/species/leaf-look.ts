import type { LeafPoint, Outline } from "./outline";
import type { Colour } from "./picture";

/** How the leaves of a species look and how they sit on a shoot. */
export interface LeafLook {
  outline: Outline;
  /** Veins on the right half, each from its root to its end. */
  veins: readonly (readonly [LeafPoint, LeafPoint])[];
  /** Colours that the leaves of one card vary around: one set for each of the four cards. */
  palettes: readonly (readonly Colour[])[];
  vein: Colour;
  stem: Colour;
  /** Length of a leaf relative to the card. */
  length: number;
  petiole: number;
  leavesPerCard: number;
  /** Angle of the leaves to the shoot, degrees. */
  angle_deg: number;
}
