/** Shader code of pass 2, shared by the colour and shadow materials. */
import type { Color, Material, WebGLProgramParametersWithUniforms } from "three";
import { LOT_SHADER } from "./boughLots";
import { EDGE, MOST_GROWTH } from "./detail";
import { WHOLE_SHARE } from "./jointAttribute";
import { LEAF_FLUTTER } from "./leafFlutter";
import type { Part } from "./mesh/treeMesh";
import { NODE_TEXEL, TURN_BY } from "./nodes/nodeTexel";
import { PULL_PARS } from "./pull/pullShader";
import type { PullUniforms } from "./pull/pullSlots";
import { type AtmosphereShader, patchColour } from "./treeLight";

export type { AtmosphereShader } from "./treeLight";

export interface TreeUniforms extends Partial<PullUniforms> {
  /** Target of pass 1; null for static trees. */
  uNodes: { value: unknown };
  uNodeShift: { value: number };
  /** Time (s) and amplitude of the leaf flutter; amplitude 0 disables it. */
  uFlutter: { value: { x: number; y: number } };
  /** Factor of the displacements; those in the target of pass 1 already have it. */
  uExaggeration: { value: number };
}

/** Surface uniforms shared by all trees. */
export interface SurfaceUniforms {
  /** Snow cover: 0 none, 1 on all surfaces that face the sky. */
  readonly uSnow: { value: number };
  readonly uSnowColour: { value: Color };
  /** Share of the leaves that are still on the tree. */
  readonly uLeafShare: { value: number };
  /** Sunlight before any shadow, and sky light on level ground. */
  readonly uSunColour: { value: Color };
  readonly uSkyColour: { value: Color };
}

const VERTEX_PARS = /* glsl */ `
attribute vec4 aPlace; // x, y, z in m; first texel of the tree in the node target
attribute vec4 aTurn;  // scale*cos(yaw), scale*sin(yaw), scale, share of the pieces that are drawn
attribute vec4 aTint;  // colour; weight relative to the texture colour
attribute vec4 aAnchor; // base of the branch or petiole, to which it shrinks; lot of its bough, negative: every tree has it
attribute vec4 aPiece; // random number of the piece, openness to the sky, flutter weight, rank
#ifndef STILL
attribute vec4 aJoint; // the two nodes between which the vertex is held, share of the second / WHOLE_SHARE
attribute vec3 aPivot; // where it is held
uniform highp usampler2D uNodes;
uniform int uNodeShift;
uniform float uExaggeration;
${NODE_TEXEL}${TURN_BY}${PULL_PARS}
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
uniform float uLeafShare;
varying vec4 vTint;
varying vec4 vPiece;
${LOT_SHADER}${LEAF_FLUTTER}`;

const NORMAL = /* glsl */ `
#ifdef STILL
  vec3 facing = normal;
#else
  takeJoint();
  vec3 facing = turnedBy(heldTurn, normal);
#endif
vec3 objectNormal = normalize(vec3(
  aTurn.x * facing.x + aTurn.y * facing.z, aTurn.z * facing.y, aTurn.x * facing.z - aTurn.y * facing.x));
`;

const POSITION = /* glsl */ `
float grown = clamp((aTurn.w * ${1 + EDGE} - aPiece.w) / (${EDGE} * aTurn.w), 0.0, 1.0);
#ifdef LEAVES
  grown *= min(${MOST_GROWTH.toFixed(1)}, inversesqrt(aTurn.w));
#endif
grown *= hasLot(aAnchor.w, aPlace.xz);
vec3 local = mix(aAnchor.xyz, position, grown);
#ifndef STILL
  #ifdef SHADOW
    takeJoint(); // the shadow pass has no normals
  #endif
  #ifdef LEAVES
    vec3 pivot = aPivot;
    float leafSwing = uFlutter.y * aPiece.z * leafAngle(aPiece.x, heldWind, uFlutter.x + dot(aPlace.xz, vec2(0.7, 1.1)));
    local = aAnchor.xyz + turned(local - aAnchor.xyz, leafAxis(aPiece.x), leafSwing);
  #else
    vec3 pivot = mix(aAnchor.xyz, aPivot, grown); // a branch that shrinks to its base ends there
  #endif
  local = pivot + heldMoved + turnedBy(heldTurn, local - pivot) + uExaggeration * pulledBy();
#endif
#ifdef LEAVES
  local *= step(aPiece.x, uLeafShare); // fallen leaves collapse to a point
#endif
vec3 transformed = aPlace.xyz + vec3(
  aTurn.x * local.x + aTurn.y * local.z, aTurn.z * local.y, aTurn.x * local.z - aTurn.y * local.x);
vTint = aTint;
vPiece = aPiece;
#if defined(LEAVES) && !defined(STILL)
  vPiece.y = clamp(vPiece.y * (1.0 + 0.5 * leafSwing), 0.0, 1.0); // a leaf that turns catches more light, or less
#endif
`;

type Pass = "colour" | "depth";

function patchVertex(
  shader: WebGLProgramParametersWithUniforms,
  part: Part,
  pass: Pass,
  moves: boolean,
): void {
  const defined = [part === "leaves" && "LEAVES", pass === "depth" && "SHADOW", !moves && "STILL"].filter(
    (name) => name !== false,
  );
  const defines = defined.map((name) => `#define ${name}\n`).join("");
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", `#include <common>\n${defines}${VERTEX_PARS}`)
    .replace("#include <beginnormal_vertex>", NORMAL)
    .replace("#include <begin_vertex>", POSITION);
}

/** Adds the deformation of pass 2 to a material, or none. Each combination compiles to its own program, hence the key. */
export function deform(
  material: Material,
  part: Part,
  pass: Pass,
  moves: boolean,
  uniforms: object,
  atmosphere: AtmosphereShader,
): void {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    patchVertex(shader, part, pass, moves);
    if (pass === "colour") patchColour(shader, part, atmosphere);
  };
  material.customProgramCacheKey = () => `galewood-${part}-${pass}-${moves}-${atmosphere.key}`;
}
