/** Shader code of leaves that are drawn one by one close to the eye, and of the cards and sprays that give way to them. */
import { HANG_SHARE } from "../treeModel/leafSprays";

/** Weight of a blade's own direction beside that of the crown at its card. */
const OWN_NORMAL_WEIGHT = 1;

/** Attributes of an instance: name, components; in the order of `CLOSE_FLOATS`. */
export const CLOSE_ATTRIBUTES = [
  ["aPlace", 4],
  ["aTurn", 4],
  ["aTint", 4],
  ["aJoint", 4],
  ["aPivot", 4],
  ["aFoot", 4],
  ["aAlong", 4],
  ["aFacing", 4],
  ["aCrown", 4],
  ["color", 3],
] as const;
/** The colour is declared by three.js. */
const VEC4_DECLARATIONS = CLOSE_ATTRIBUTES.filter(([name]) => name !== "color" && name !== "aPivot")
  .map(([name]) => `attribute vec4 ${name};`)
  .join("\n");

/** Takes the place of the attributes of trees and pieces: what a vertex of a shape is in the frame of its tree. */
export const SINGLE_ATTRIBUTES = /* glsl */ `
${VEC4_DECLARATIONS}
attribute vec3 aPivot;
attribute vec4 aLeaf; // foot of the leaf in the frame of the spray, random number; 0: the shoot
vec4 aAnchor;
vec4 aPiece;
vec3 bladeAt;
vec3 bladeNormal;
vec3 bladeOwn; // without that of the crown
varying vec3 vBlade;
vec3 ofSpray(vec3 v) {
  vec3 axis = normalize(aAlong.xyz);
  return aFacing.w * v.x * cross(axis, aFacing.xyz) + v.y * axis + v.z * aFacing.xyz;
}
vec3 onSpray(vec3 v) {
  float size = length(aAlong.xyz);
  vec3 at = aFoot.xyz + size * ofSpray(v);
  at.y -= ${HANG_SHARE} * size * v.y * v.y;
  return at;
}
void takeTree() {
  bladeAt = onSpray(position);
  aAnchor = vec4(onSpray(aLeaf.xyz), aFoot.w);
  bladeOwn = ofSpray(normal);
  float side = dot(bladeOwn, aCrown.xyz) < 0.0 ? -1.0 : 1.0;
  bladeNormal = normalize(aCrown.xyz + ${OWN_NORMAL_WEIGHT.toFixed(1)} * side * bladeOwn);
  float leaf = step(1e-6, aLeaf.w);
  aPiece = vec4(leaf * fract(aLeaf.w + aAlong.w), aCrown.w, leaf, 1.0);
}
#define position bladeAt
#define normal bladeNormal
`;

/** Vertex shader of leaves: the normal of a blade in the frame of the view. */
export const BLADE_NORMAL = /* glsl */ `
#include <defaultnormal_vertex>
#ifdef SINGLE_LEAVES
vBlade = normalMatrix * stoodNormal(turnedBy(heldTurn, bladeOwn));
#endif
`;

/** Share of the distance up to which there are single leaves, from which on cards and sprays are drawn as well. */
const BOTH_FROM_SHARE = 0.85;

/** `uClose`: the eye, and that distance, m; 0: there are no single leaves. */
const BEYOND_CLOSE = /* glsl */ `
uniform vec4 uClose;
float beyondClose(vec3 foot) {
  float away = distance(aPlace.xyz + stood(foot), uClose.xyz);
  return uClose.w > 0.0 ? smoothstep(${BOTH_FROM_SHARE} * uClose.w, uClose.w, away) : 1.0;
}
`;

/** Size of cards and sprays, and of the single leaves of a spray. */
export const OTHER_LEAF_SHARE = `${BEYOND_CLOSE}float leafShare() { return beyondClose(aAnchor.xyz); }\n`;
export const SINGLE_LEAF_SHARE = `${BEYOND_CLOSE}float leafShare() { return 1.0 - beyondClose(aFoot.xyz); }\n`;
