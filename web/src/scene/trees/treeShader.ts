/** Shader code of pass 2, shared by the colour and shadow materials. */
import type { Color, Material, WebGLProgramParametersWithUniforms } from "three";
import { EDGE, MOST_GROWTH } from "./detail";
import type { Part } from "./mesh/treeMesh";
import { PULL_PARS } from "./pull/pullShader";
import type { PullUniforms } from "./pull/pullSlots";

export interface TreeUniforms extends Partial<PullUniforms> {
  /** Target of pass 1; null for static trees. */
  uNodes: { value: unknown };
  uNodeShift: { value: number };
  /** Time (s) and amplitude of the leaf flutter; amplitude 0 disables it. */
  uFlutter: { value: { x: number; y: number } };
  /** 1 while the motion of this species is still being computed. */
  uGhost: { value: number };
}

/** Surface uniforms shared by all trees. */
export interface SurfaceUniforms {
  /** Snow cover: 0 none, 1 on all surfaces that face the sky. */
  readonly uSnow: { value: number };
  readonly uSnowColour: { value: Color };
  /** Share of the leaves that are still on the tree. */
  readonly uLeafShare: { value: number };
}

/** Atmospheric perspective, as shader code that the scene supplies. */
export interface AtmosphereShader {
  /** Part of the program's cache key: differs where the code differs. */
  readonly key: string;
  readonly uniforms: Readonly<Record<string, { value: unknown }>>;
  /** GLSL declarations and functions for the fragment shader. */
  readonly declarations: string;
  /** Replaces three's `opaque_fragment`; works on linear light before tone mapping. */
  readonly output: string;
}

const VERTEX_PARS = /* glsl */ `
attribute vec4 aPlace; // x, y, z in m; first texel of the tree in the node target
attribute vec4 aTurn;  // scale*cos(yaw), scale*sin(yaw), scale, share of the pieces that are drawn
attribute vec4 aTint;  // colour; weight relative to the texture colour
attribute vec3 aAnchor; // point to which the leaf or branch shrinks
attribute vec4 aPiece; // random number of the piece, openness to the sky, flutter weight, rank
#ifndef STILL
attribute float aNode;
uniform highp sampler2D uNodes;
uniform int uNodeShift;
${PULL_PARS}
#endif
uniform vec2 uFlutter;
uniform float uLeafShare;
varying vec4 vTint;
varying vec4 vPiece;
`;

const NORMAL = /* glsl */ `
vec3 objectNormal = normalize(vec3(
  aTurn.x * normal.x + aTurn.y * normal.z, aTurn.z * normal.y, aTurn.x * normal.z - aTurn.y * normal.x));
`;

const POSITION = /* glsl */ `
float grown = clamp((aTurn.w * ${1 + EDGE} - aPiece.w) / (${EDGE} * aTurn.w), 0.0, 1.0);
#ifdef LEAVES
  grown *= min(${MOST_GROWTH.toFixed(1)}, inversesqrt(aTurn.w));
#endif
vec3 local = mix(aAnchor, position, grown);
#ifndef STILL
  int nodeIndex = int(aPlace.w + 0.5) + int(aNode + 0.5);
  vec4 motion = texelFetch(uNodes, ivec2(nodeIndex & ((1 << uNodeShift) - 1), nodeIndex >> uNodeShift), 0);
  local += motion.xyz + pulledBy();
  #ifdef LEAVES
    float tremble = uFlutter.y * aPiece.z * min(motion.w, 14.0) * 0.0045;
    float beat = uFlutter.x * (5.0 + 4.0 * aPiece.x) + 40.0 * aPiece.x + dot(aPlace.xz, vec2(1.7, 2.3));
    local += tremble * vec3(sin(beat), 0.7 * sin(beat * 1.31 + 1.0), cos(beat * 0.83));
  #endif
#endif
#ifdef LEAVES
  local *= step(aPiece.x, uLeafShare); // fallen leaves collapse to a point
#endif
vec3 transformed = aPlace.xyz + vec3(
  aTurn.x * local.x + aTurn.y * local.z, aTurn.z * local.y, aTurn.x * local.z - aTurn.y * local.x);
vTint = aTint;
vPiece = aPiece;
`;

const FRAGMENT_PARS = /* glsl */ `
uniform float uGhost;
uniform float uSnow;
uniform vec3 uSnowColour;
varying vec4 vTint;
varying vec4 vPiece;
`;

const LEAF_MAP = /* glsl */ `
#ifdef USE_MAP
  vec4 leaf = texture2D(map, vMapUv);
  vec2 texels = vec2(textureSize(map, 0));
  vec2 right = dFdx(vMapUv) * texels;
  vec2 down = dFdy(vMapUv) * texels;
  float area = abs(right.x * down.y - right.y * down.x) + 1e-4;
  // Mip levels reduce the alpha coverage: restore it.
  leaf.a *= 1.0 + 0.14 * max(0.0, log2(area));
  // A card seen edge-on is a smear of all its leaves, so fade it: 1 from the front, twice the cosine at the edge.
  leaf.a *= smoothstep(0.1, 0.5, 2.0 * area / (dot(right, right) + dot(down, down)));
  diffuseColor *= leaf;
#endif
float shade = dot(diffuseColor.rgb, vec3(0.2126, 0.7152, 0.0722));
vec3 autumn = vTint.rgb * (0.35 + 1.9 * shade);
diffuseColor.rgb = mix(diffuseColor.rgb, autumn, vTint.a);
diffuseColor.rgb *= 0.8 + 0.42 * vPiece.x;
diffuseColor.rgb = mix(diffuseColor.rgb, diffuseColor.rgb * vec3(1.12, 0.92, 0.7), 0.6 * fract(vPiece.x * 7.31));
`;

const WOOD_MAP = /* glsl */ `
#include <map_fragment>
// Darken pale bark, which would be white in sunlight.
diffuseColor.rgb *= (0.85 + 0.3 * vPiece.x) * (1.0 - 0.5 * diffuseColor.g);
`;

/** Snow in patches on surfaces that face the sky. */
const SNOW = /* glsl */ `
#include <normal_fragment_maps>
float skyward = dot(normal, (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz);
float lying = smoothstep(0.05, 0.5, skyward + 0.35 * (fract(vPiece.x * 7.0) - 0.6)) * uSnow;
diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, lying);
`;

const GHOST = /* glsl */ `
diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.36, 0.43, 0.5) * (0.5 + dot(diffuseColor.rgb, vec3(0.5))), 0.88 * uGhost);
`;

const LEAF_NORMAL = /* glsl */ `
float faceDirection = gl_FrontFacing ? 1.0 : -1.0;
vec3 normal = normalize(vNormal); // crown normals: the same from both sides
vec3 nonPerturbedNormal = normal;
`;

/** After lighting: sky light fades inside the crown, and sunlight is transmitted through leaves. */
const LEAF_LIGHT = /* glsl */ `
#include <lights_fragment_end>
reflectedLight.indirectDiffuse *= 0.3 + 0.7 * vPiece.y;
reflectedLight.directDiffuse *= 0.5 + 0.5 * vPiece.y;
float through = pow(saturate(dot(-geometryViewDir, directLight.direction)), 3.0);
float behind = saturate(0.45 - 0.55 * dot(geometryNormal, directLight.direction));
reflectedLight.directDiffuse += directLight.color * diffuseColor.rgb * vPiece.y * (0.55 * through + 0.34 * behind)
  * vec3(1.05, 1.0, 0.62) * RECIPROCAL_PI;
`;

const WOOD_LIGHT = /* glsl */ `
#include <lights_fragment_end>
reflectedLight.indirectDiffuse *= 0.35 + 0.65 * vPiece.y;
`;

function patchVertex(shader: WebGLProgramParametersWithUniforms, part: Part, moves: boolean): void {
  const defines = `${part === "leaves" ? "#define LEAVES\n" : ""}${moves ? "" : "#define STILL\n"}`;
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", `#include <common>\n${defines}${VERTEX_PARS}`)
    .replace("#include <beginnormal_vertex>", NORMAL)
    .replace("#include <begin_vertex>", POSITION);
}

function patchColour(
  shader: WebGLProgramParametersWithUniforms,
  part: Part,
  atmosphere: AtmosphereShader,
): void {
  const leaves = part === "leaves";
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <common>", `#include <common>\n${FRAGMENT_PARS}${atmosphere.declarations}`)
    .replace("#include <map_fragment>", (leaves ? LEAF_MAP : WOOD_MAP) + GHOST)
    .replace("#include <lights_fragment_end>", leaves ? LEAF_LIGHT : WOOD_LIGHT)
    .replace("#include <normal_fragment_maps>", SNOW)
    .replace("#include <opaque_fragment>", atmosphere.output)
    .replace("#include <fog_fragment>", "");
  if (leaves)
    shader.fragmentShader = shader.fragmentShader.replace("#include <normal_fragment_begin>", LEAF_NORMAL);
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
