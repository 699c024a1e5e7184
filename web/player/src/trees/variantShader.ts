/** Shader code of the variants of a species (limbKeys.ts). */

/** Share of the limbs that a tree lacks. */
export const MISSING_BRANCH_SHARE = 0.22;
/** Key of what every tree has. */
export const COMMON_KEY = -1;

/** 1 where the tree at a place (x, z) has the pieces of this key, 0 where it lacks it. */
export const VARIANT_SHADER = /* glsl */ `
float hasVariant(float key, vec2 place) {
  return step(${MISSING_BRANCH_SHARE}, fract(key + dot(place, vec2(0.731, 0.417))) + step(key, -0.5));
}
`;
