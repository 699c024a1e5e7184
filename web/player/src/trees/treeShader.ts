/** Shader code of pass 2, shared by the colour and shadow materials. */
import type { Material, Texture, WebGLProgramParametersWithUniforms } from "three";
import { MOST_LEAF_GROWTH, SHRINK_RANK_WIDTH } from "../core/constants";
import { MOST_SHARE, NEAR_RANK } from "./detail";
import { WHOLE_SHARE } from "./jointAttribute";
import { AHEAD_X_S_PER_M, AHEAD_Z_S_PER_M, LEAF_FLUTTER } from "./leafFlutter";
import { LEAN_SHADER } from "./lean";
import type { Part } from "./mesh/partArrays";
import { NODE_TEXEL, TURN_BY } from "./nodes/nodeTexel";
import type { PullUniforms } from "./pull/pullSlots";
import { VARIANT_SHADER } from "./variantShader";

/** The trees of one pass whose levels of detail are drawn with one call (together/). */
export interface TreesUniforms {
  readonly uTrees: { value: Texture };
  /** First tree of each draw of the call. */
  readonly uTreesFrom: { readonly value: Int32Array };
}

/** Those of the colour pass and of the shadow maps. */
export interface TogetherUniforms {
  readonly seen: TreesUniforms;
  readonly casting: TreesUniforms;
}

export interface TreeUniforms extends Partial<PullUniforms> {
  /** Texture of the target of pass 1, the first one if it has two; null for static trees. */
  uNodes: { value: Texture | null };
  uNodeShift: { value: number };
  /** Time (s) and amplitude of the leaf flutter; amplitude 0 disables it. */
  uFlutter: { value: { x: number; y: number } };
  /** Mean frequency of that, Hz. */
  uLeafHz: { value: number };
  /** 1 for trees that stand upright and have a lean of their own, else 0. */
  uLean: { value: number };
  /** Factor of the displacements; those in the target of pass 1 already have it. */
  uExaggeration: { value: number };
  /** The eye, and the distance (m) from it up to which leaves are drawn one by one (closeLeaves.ts); 0: none are. */
  uClose: { value: { x: number; y: number; z: number; w: number } };
}

/** Uniforms of a species, from which materials are made. */
export interface SpeciesUniforms extends TreeUniforms {
  /** Of trees whose levels of detail are drawn with one call. */
  readonly together?: TogetherUniforms;
}

/** What is known of a tree, and the joint of a vertex: as attributes of the instance and of its level. */
const TREE_ATTRIBUTES = /* glsl */ `
attribute vec4 aPlace; // x, y, z in m; first texel of the tree in the node target
attribute vec4 aTurn;  // see TURNED; scale, share of the pieces that are drawn
attribute vec4 aTint;  // see TURNED
#ifndef STILL
attribute vec4 aJoint; // the two nodes between which the vertex is held, share of the second / WHOLE_SHARE
#endif
`;

const PIECE_ATTRIBUTES = /* glsl */ `
attribute vec4 aAnchor; // base of the branch or petiole, to which it shrinks; key of its limb, negative: every tree has it
attribute vec4 aPiece; // random number of the piece, openness to the sky, flutter weight, rank
#ifndef STILL
attribute vec3 aPivot; // where it is held
#endif
`;

const VERTEX_PARS = /* glsl */ `
#ifndef STILL
uniform highp usampler2D uNodes;
uniform int uNodeShift;
uniform float uExaggeration;
${NODE_TEXEL}${TURN_BY}
vec3 heldMoved; // displacement and turn of the joint, and the wind there
vec4 heldTurn;
float heldWind;
void takeJoint() {
  int tree = int(aPlace.w + 0.5);
  uvec4 first = nodeTexel(uNodes, tree + int(aJoint.x + 0.5), uNodeShift);
  heldMoved = nodeMoved(first);
  heldWind = nodeWind(first);
  vec3 curl = nodeTurned(first);
  if (aJoint.z > 0.5) {
    float share = aJoint.z / ${WHOLE_SHARE.toFixed(1)};
    uvec4 second = nodeTexel(uNodes, tree + int(aJoint.y + 0.5), uNodeShift);
    heldMoved = mix(heldMoved, nodeMoved(second), share);
    curl = mix(curl, nodeTurned(second), share);
  }
  heldTurn = turnOf(curl);
}
#endif
uniform vec2 uFlutter;
uniform float uLeafHz;
uniform float uLeafShare;
varying vec4 vTint;
varying vec4 vPiece;
float pieceSize(float rank) {
  return clamp((aTurn.w * ${1 + SHRINK_RANK_WIDTH} - rank) / (${SHRINK_RANK_WIDTH} * aTurn.w), 0.0, 1.0);
}
${VARIANT_SHADER}${LEAF_FLUTTER}`;

/** How trees stand: upright with a lean of their own, turned about the vertical and of one scale; or as any matrix without shear says. */
export type Standing = "upright" | "oriented";

/**
 * From the tree's frame to the scene's: `stood` for places, `stoodNormal` for directions of any length.
 * Upright: aTurn.xy is scale·(cos, sin) of the yaw, aTint the colour and its weight relative to the texture's.
 * Oriented: (aTurn.xy, aTint.xy) is a quaternion times the root of the scale along y, aTint.zw the scales along x and z over it.
 */
const STANDING_GLSL: Record<Standing, string> = {
  upright: /* glsl */ `
uniform float uLean;
${LEAN_SHADER}
vec3 stoodNormal(vec3 v) {
  return vec3(aTurn.x * v.x + aTurn.y * v.z, aTurn.z * v.y, aTurn.x * v.z - aTurn.y * v.x);
}
vec3 stood(vec3 v) {
  vec3 upright = stoodNormal(v);
  upright.xz += uLean * upright.y * leanOf(aPlace.xz);
  return upright;
}
`,
  oriented: /* glsl */ `
vec3 spun(vec3 v) {
  vec4 q = vec4(aTurn.xy, aTint.xy);
  return (q.w * q.w - dot(q.xyz, q.xyz)) * v + 2.0 * (dot(q.xyz, v) * q.xyz + q.w * cross(q.xyz, v));
}
vec3 stood(vec3 v) {
  return spun(v * vec3(aTint.z, 1.0, aTint.w));
}
vec3 stoodNormal(vec3 v) {
  return spun(v / vec3(aTint.z, 1.0, aTint.w));
}
`,
};

const NORMAL_GLSL = /* glsl */ `
#ifdef STILL
  vec3 facing = normal;
#else
  vec3 facing = turnedBy(heldTurn, normal);
#endif
vec3 objectNormal = normalize(stoodNormal(facing));
`;

const POSITION_GLSL = /* glsl */ `
float grown = pieceSize(aPiece.w);
#ifdef LEAVES
  if (aPiece.w < 1.0) grown *= 1.0 - pieceSize(${NEAR_RANK} + ${(MOST_SHARE - NEAR_RANK).toFixed(2)} * aPiece.w); // see detail.ts
  float leafGrowth = min(${MOST_LEAF_GROWTH.toFixed(1)}, inversesqrt(min(aTurn.w, 1.0)));
  grown *= leafGrowth;
  #ifdef LEAF_SHARE
    grown *= leafShare();
  #endif
#endif
grown *= hasVariant(aAnchor.w, aPlace.xz);
vec3 local = mix(aAnchor.xyz, position, grown);
#ifndef STILL
  #ifdef LEAVES
    vec3 pivot = aPivot;
    float leafSwing = uFlutter.y * aPiece.z * leafAngle(aPiece.x, uLeafHz, heldWind, uFlutter.x + dot(aPlace.xz, vec2(${AHEAD_X_S_PER_M}, ${AHEAD_Z_S_PER_M})));
    local = aAnchor.xyz + turned(local - aAnchor.xyz, leafAxis(aPiece.x), leafSwing);
  #else
    vec3 pivot = mix(aAnchor.xyz, aPivot, grown); // a branch that shrinks to its base ends there
  #endif
  local = pivot + heldMoved + turnedBy(heldTurn, local - pivot);
  #ifdef PULLED
    local += uExaggeration * pulledBy();
  #endif
#endif
#ifdef LEAVES
  local *= step(aPiece.x, uLeafShare); // fallen leaves collapse to a point
#endif
vec3 transformed = aPlace.xyz + stood(local);
vTint = aTint;
vPiece = aPiece;
#ifdef LEAVES
  vPiece.z = leafGrowth; // for the picture of an enlarged leaf
#endif
#if defined(LEAVES) && !defined(STILL)
  vPiece.y = clamp(vPiece.y * (1.0 + 0.5 * leafSwing), 0.0, 1.0); // a leaf that turns catches more light, or less
  vPiece.w = uFlutter.y * heldWind; // for the leaves of a spray, which move against each other
#endif
`;

/** What tells one program from another. */
export interface Variant {
  readonly part: Part;
  /** Trees that do not move are drawn without any deformation. */
  readonly moves: boolean;
  readonly standing: Standing;
  /** Part of the key of the program: differs where the code of `further` differs. */
  readonly key: string;
  /** GLSL of `pulledBy()`, the displacement of a vertex by pulls; without it there are none. */
  readonly pulls?: string;
  /** GLSL of `leafShare()`, by which a leaf is smaller than its rank says; `key` tells. */
  readonly leafShare?: string;
  /** GLSL in place of the attributes of a tree, for a call that draws all levels of detail (together/togetherShader.ts); `key` tells. */
  readonly together?: string;
  /** GLSL in place of all attributes, those of a piece as well, with `takeTree()`; `key` tells. */
  readonly attributes?: string;
}

function patchVertex(
  shader: WebGLProgramParametersWithUniforms,
  { part, moves, standing, pulls, leafShare, together, attributes }: Variant,
): void {
  const defined = [part === "leaves" && "LEAVES", !moves && "STILL"].filter((name) => name !== false);
  const pulled = pulls && moves ? `#define PULLED\n${pulls}` : "";
  const share = leafShare ? `#define LEAF_SHARE\n${leafShare}` : "";
  const defines = defined.map((name) => `#define ${name}\n`).join("");
  const given = attributes ?? (together ?? TREE_ATTRIBUTES) + PIECE_ATTRIBUTES;
  shader.vertexShader = shader.vertexShader
    .replace(
      "#include <common>",
      `#include <common>\n${defines}${given}${VERTEX_PARS}${STANDING_GLSL[standing]}${share}${pulled}`,
    )
    .replace("#include <beginnormal_vertex>", NORMAL_GLSL)
    .replace("#include <begin_vertex>", POSITION_GLSL);
  // First of all, because not every material has normals.
  const first = (together || attributes ? "takeTree();" : "") + (moves ? "takeJoint();" : "");
  shader.vertexShader = shader.vertexShader.replace("void main() {", `void main() {${first}`);
}

/**
 * Adds the deformation of pass 2 to a material, or none. Each combination compiles to its own program, hence the key.
 * `further` changes the rest of the shader.
 */
export function deform(
  material: Material,
  variant: Variant,
  uniforms: object,
  further: (shader: WebGLProgramParametersWithUniforms) => void = () => {},
): void {
  const { part, moves, standing, key } = variant;
  const before = material.onBeforeCompile;
  const keyBefore = material.customProgramCacheKey();
  material.onBeforeCompile = (shader, renderer) => {
    before.call(material, shader, renderer);
    Object.assign(shader.uniforms, uniforms);
    patchVertex(shader, variant);
    further(shader);
  };
  material.customProgramCacheKey = () => `galewood-${part}-${moves}-${standing}-${key}-${keyBefore}`;
}
