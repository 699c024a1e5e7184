/** Cross-fade between a tree's geometry and its impostor, by distance. Pure. */

/** The fade ends at this multiple of the distance at which it begins. */
export const FADE_END = 1.24;

export interface Fade {
  /** Opacity of the impostor. */
  readonly card: number;
  /** Share of the geometry's pieces that remain: they shrink once the impostor covers the tree. */
  readonly pieces: number;
}

const ALL_PIECES: Fade = { card: 0, pieces: 1 };
const CARD_ONLY: Fade = { card: 1, pieces: 0 };

/** First the impostor appears in front of the complete geometry, then the geometry disappears. */
export function fadeAt(distance_m: number, from_m: number): Fade {
  if (distance_m <= from_m) return ALL_PIECES;
  const way = (distance_m / from_m - 1) / (FADE_END - 1);
  if (way >= 1) return CARD_ONLY;
  return { card: Math.min(1, 2 * way), pieces: Math.min(1, 2 - 2 * way) };
}
