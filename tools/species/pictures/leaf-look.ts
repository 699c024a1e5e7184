import type { LeafPoint, Outline } from "./outline";
import type { Colour } from "./picture";

/** Appearance of the leaves of a species, and their arrangement on a shoot. */
export interface LeafLook {
  outline: Outline;
  /** Veins on the right half, each from its start to its end. */
  veins: readonly (readonly [LeafPoint, LeafPoint])[];
  /** Base colours of the leaves: one set for each of the four cards. */
  palettes: readonly (readonly Colour[])[];
  vein: Colour;
  stem: Colour;
  /** Length of a leaf relative to the card. */
  length: number;
  petiole: number;
  leavesPerCard: number;
  leavesPerSpray: number;
  /** Side shoots of the shoot on a card. */
  sideShoots: number;
  /** A fuller shoot, which browsers draw on the card; the leaf area and mass of the tree are those of the other one. */
  fuller?: {
    sideShoots: number;
    /** Length of the side shoots relative to usual ones. */
    sideLength: number;
    leavesPerCard: number;
  };
  /** Whether the shoot of a spray has side shoots as well. */
  branchedSpray: boolean;
  /** Angle of the leaves to the shoot, degrees. */
  angle_deg: number;
}
