/** Shader code of the variants of a species (limbLots.ts). */

/** Share of the limbs that a tree lacks. */
export const MISSING_BRANCH_SHARE = 0.22;
/** Lot of what every tree has. */
export const COMMON_LOT = -1;

/** 1 where the tree at a place (x, z) has the pieces of this lot, 0 where it lacks it. */
export const LOT_SHADER = /* glsl */ `
float hasLot(float lot, vec2 place) {
  return step(${MISSING_BRANCH_SHARE}, fract(lot + dot(place, vec2(0.731, 0.417))) + step(lot, -0.5));
}
`;
