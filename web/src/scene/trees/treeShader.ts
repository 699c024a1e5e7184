/** Shader code of pass 2, shared by the colour and shadow materials. */
import type { Color, Material, WebGLProgramParametersWithUniforms } from "three";
import { LOT_SHADER } from "./boughLots";
import { EDGE, MOST_GROWTH } from "./detail";
import { LEAF_FLUTTER } from "./leafFlutter";
import type { Part } from "./mesh/treeMesh";
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
  /** Factor of the displacements. */
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
attribute float aNode;
uniform highp sampler2D uNodes;
uniform int uNodeShift;
uniform float uExaggeration;
${PULL_PARS}
#endif
uniform vec2 uFlutter;
uniform float uLeafShare;
varying vec4 vTint;
varying vec4 vPiece;
${LOT_SHADER}${LEAF_FLUTTER}`;

const NORMAL = /* glsl */ `
vec3 objectNormal = normalize(vec3(
  aTurn.x * normal.x + aTurn.y * normal.z, aTurn.z * normal.y, aTurn.x * normal.z - aTurn.y * normal.x));
`;

const POSITION = /* glsl */ `
float grown = clamp((aTurn.w * ${1 + EDGE} - aPiece.w) / (${EDGE} * aTurn.w), 0.0, 1.0);
#ifdef LEAVES
  grown *= min(${MOST_GROWTH.toFixed(1)}, inversesqrt(aTurn.w));
#endif
grown *= hasLot(aAnchor.w, aPlace.xz);
vec3 local = mix(aAnchor.xyz, position, grown);
#ifndef STILL
  int nodeIndex = int(aPlace.w + 0.5) + int(aNode + 0.5);
  vec4 motion = texelFetch(uNodes, ivec2(nodeIndex & ((1 << uNodeShift) - 1), nodeIndex >> uNodeShift), 0);
  #ifdef LEAVES
    float leafSwing = uFlutter.y * aPiece.z * leafAngle(aPiece.x, motion.w, uFlutter.x + dot(aPlace.xz, vec2(0.7, 1.1)));
    local = aAnchor.xyz + turned(local - aAnchor.xyz, leafAxis(aPiece.x), leafSwing);
  #endif
  local += uExaggeration * (motion.xyz + pulledBy());
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

function patchVertex(shader: WebGLProgramParametersWithUniforms, part: Part, moves: boolean): void {
  const defines = `${part === "leaves" ? "#define LEAVES\n" : ""}${moves ? "" : "#define STILL\n"}`;
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", `#include <common>\n${defines}${VERTEX_PARS}`)
    .replace("#include <beginnormal_vertex>", NORMAL)
    .replace("#include <begin_vertex>", POSITION);
}

/** Adds the deformation of pass 2 to a material, or none. Each combination compiles to its own program, hence the key. */
export function deform(
  material: Material,
  part: Part,
  pass: "colour" | "depth",
  moves: boolean,
  uniforms: object,
  atmosphere: AtmosphereShader,
): void {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    patchVertex(shader, part, moves);
    if (pass === "colour") patchColour(shader, part, atmosphere);
  };
  material.customProgramCacheKey = () => `galewood-${part}-${pass}-${moves}-${atmosphere.key}`;
}
