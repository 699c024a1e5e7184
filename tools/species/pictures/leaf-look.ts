import type { LeafPoint, Outline } from "./outline";
import type { Colour } from "./picture";

/** How side shoots differ from usual ones. */
export interface SideShoots {
  /** Length and rise of the lowest, relative to usual ones. */
  sideLength?: number;
  sideRise?: number;
  /** How much shorter the uppermost is than the lowest, and how much less it rises. */
  shortening?: number;
  lessRise?: number;
  /** Where the lowest starts, relative to the length of the main shoot. */
  lowest?: number;
}

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
  fuller?: SideShoots & { sideShoots: number; leavesPerCard: number; length?: number };
  /** Side shoots of the shoot of a spray; null: it has none. */
  sprayShoots: SideShoots | null;
  /** Angle of the leaves to the shoot, degrees. */
  angle_deg: number;
}
