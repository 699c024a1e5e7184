/** Shader code of the variants of a species (boughLots.ts). */

/** Share of the boughs that a tree lacks. */
export const MISSING_BRANCH_SHARE = 0.22;
/** Lot of what every tree has. */
export const COMMON_LOT = -1;

/** 1 where the tree at a place (x, z) has what bears this lot, 0 where it lacks it. */
export const LOT_SHADER = /* glsl */ `
float hasLot(float lot, vec2 place) {
  return step(${MISSING_BRANCH_SHARE}, fract(lot + dot(place, vec2(0.731, 0.417))) + step(lot, -0.5));
}
`;
