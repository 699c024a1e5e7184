/** Displayed coordinates of distant trees, as many as the coarsest level of detail draws: two texels with the wind. */
export const FAR_COORDINATES = 7;

/**
 * The coordinates of a pose by which a tree is drawn with `count` of them, in ascending order: the first oscillators, which
 * move it most, and the first of the modes that follow all oscillators. That one is how a bent tree loses height, a fifth of
 * its sway in a storm. `oscillators`: of the table.
 */
export function leadingCoordinates(
  modes: number,
  oscillators: number,
  count: number,
): Uint16Array<ArrayBuffer> {
  const kept = Math.min(modes, count);
  const coordinates = Uint16Array.from({ length: kept }, (_, k) => k);
  if (oscillators < modes && kept > 0) coordinates[kept - 1] = Math.max(kept - 1, oscillators);
  return coordinates;
}
