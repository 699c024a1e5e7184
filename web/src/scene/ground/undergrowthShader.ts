/** Shader code of everything in the undergrowth: cards with a picture, flat leaves, and bodies of wood, stone and mushrooms. */
import { BLADE_GLSL } from "../season/looseLeaf";
import { GROUND_WIND_PARS } from "./groundWind";
import { KIND_LOOKS, type PlantKind } from "./plantKinds";

/** What the shaders are compiled for. */
export function definesOf(kind: PlantKind): string {
  const { bend, surface } = KIND_LOOKS[kind];
  return `#define BEND ${bend.toFixed(2)}\n#define ${surface.toUpperCase()}\n#define ${kind.toUpperCase()}\n`;
}

export const VERTEX_PARS = /* glsl */ `
attribute vec4 aPlant; // x, y, z, size in m
attribute vec4 aLook; // colour; random number. Bodies: slope of the ground along x and z, hue; random number
uniform float uSeconds;
uniform vec3 uEye;
uniform float uReach;
varying vec2 vPlant;
varying vec4 vLook;
varying float vUp;
${GROUND_WIND_PARS}`;

export const NORMAL_GLSL = /* glsl */ `
float turn = aLook.w * 6.2832;
mat2 spin = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
vec3 objectNormal = vec3(spin * normal.xz, normal.y).xzy;
#ifdef SOLID
  objectNormal = normalize(objectNormal - vec3(aLook.x, 0.0, aLook.y) * objectNormal.y);
#endif
`;

/** Depth materials have no normals. */
export const SPIN_GLSL = /* glsl */ `
float turn = aLook.w * 6.2832;
mat2 spin = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
`;

export const POSITION_GLSL = /* glsl */ `
float near = 1.0 - smoothstep(0.75, 1.0, distance(aPlant.xz, uEye.xz) / uReach);
vec2 spun = spin * position.xz;
#if defined(FLAT)
  // A fallen leaf lies askew.
  vec3 placed = vec3(spun.x, position.y + 0.5 * (fract(aLook.w * 7.0) - 0.4) * position.x, spun.y);
#elif defined(SOLID)
  vec3 placed = vec3(spun.x, position.y + dot(aLook.xy, spun), spun.y);
#else
  float beat = uSeconds * 5.0 + aLook.w * 30.0;
  vec2 along = leanAt(aPlant.xz);
  // Stronger wind shakes the twigs more.
  float shaken = 1.0 + 1.5 * length(along);
  float tremble = 1.0 + shaken * (0.12 * sin(beat) + 0.08 * sin(2.7 * beat + 9.0 * position.x));
  // A stalk that bows is bent further by its own weight and its foliage, so that a storm lays ferns and saplings over.
  float yielding = 0.75 + 0.55 * length(along);
  vec2 bow = along * BEND * yielding * tremble * position.y * position.y;
  vec3 placed = vec3(spun.x + bow.x, position.y - min(0.8 * position.y, dot(bow, bow)), spun.y + bow.y);
#endif
vec3 transformed = aPlant.xyz + aPlant.w * near * placed;
vPlant = uv;
vLook = aLook;
vUp = position.y;
`;

export const FRAGMENT_PARS = /* glsl */ `
uniform sampler2D uPlants;
uniform sampler2D uNoise;
uniform float uBare;
uniform float uSnow;
uniform vec3 uSnowColour;
uniform vec3 uSunColour;
varying vec2 vPlant;
varying vec4 vLook;
varying float vUp;
#ifdef FLAT
${BLADE_GLSL}
#endif
`;

/** Drops what is transparent; leaves `plant` and `own`. */
const CUT_GLSL = /* glsl */ `
vec4 plant = texture2D(uPlants, vPlant);
vec2 size = vec2(textureSize(uPlants, 0));
float texels = max(length(dFdx(vPlant) * size), length(dFdy(vPlant) * size));
// Mip levels reduce the coverage: restore it.
if (plant.a * (1.0 + 0.05 * max(0.0, log2(texels))) < 0.42) discard;
vec3 own = plant.rgb / max(plant.a, 0.15);
// The leaves have fallen; mip levels mix the twigs with them, so that less wood is a twig far away.
if (uBare > 0.5 && own.g < 0.3 / (1.0 + 0.6 * max(0.0, log2(texels)))) discard;
`;

export const SHADOW_GLSL = `#ifdef LEAFY\n${CUT_GLSL}#endif\n`;

export const COLOUR_GLSL = /* glsl */ `
#if defined(FLAT)
  diffuseColor.rgb = blade(vLook.rgb, vPlant);
#elif defined(SOLID)
  vec3 grain = texture2D(uNoise, vPlant * vec2(0.09, 0.2) + vLook.w).rgb;
  #if defined(STONE)
    diffuseColor.rgb = mix(vec3(0.13, 0.125, 0.115), vec3(0.24, 0.23, 0.21), grain.r) * (0.8 + 0.4 * vLook.z);
    diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.3, 0.31, 0.24), 0.6 * smoothstep(0.62, 0.7, grain.g)); // lichen
  #elif defined(MUSHROOM)
    vec3 cap = mix(vec3(0.3, 0.12, 0.04), vec3(0.42, 0.25, 0.1), vLook.z);
    diffuseColor.rgb = mix(vec3(0.5, 0.44, 0.34), cap * (0.8 + 0.4 * grain.r), smoothstep(0.6, 0.68, vUp));
  #else
    diffuseColor.rgb = mix(vec3(0.05, 0.036, 0.025), vec3(0.16, 0.12, 0.085), grain.r) * (0.8 + 0.5 * vLook.z);
  #endif
#else
  ${CUT_GLSL}
  vec3 leaf = vLook.rgb * (0.12 + 1.4 * own.r) * mix(vec3(1.15, 1.0, 0.75), vec3(0.9, 1.02, 1.1), own.b);
  diffuseColor.rgb = mix(leaf, vec3(0.12, 0.085, 0.06), own.g);
  // Deep inside the plant it is darker.
  diffuseColor.rgb *= 0.35 + 0.65 * smoothstep(0.0, 0.75, vUp);
  diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, uSnow * smoothstep(0.35, 0.7, own.r + 0.2 * vUp));
#endif
`;

/** The same normal on both sides of a card. Moss, cut wood and snow lie on bodies by the direction of their surface. */
export const NORMAL_FRAGMENT_GLSL = /* glsl */ `
vec3 normal = normalize(vNormal);
vec3 nonPerturbedNormal = normal;
#ifdef SOLID
  float skyward = dot(normal, (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz);
  #ifdef STUMP
    vec3 cut = vec3(0.36, 0.27, 0.16) * (0.75 + 0.25 * sin(70.0 * length(vPlant - 0.5)));
    diffuseColor.rgb = mix(diffuseColor.rgb, cut * (0.6 + 0.6 * grain.g), smoothstep(0.93, 0.97, vUp) * step(0.7, skyward));
  #endif
  #ifndef MUSHROOM
    float mossy = smoothstep(0.1, 0.6, skyward + 0.9 * (grain.b - 0.5) + 0.5 * (vLook.w - 0.6));
    diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.07, 0.11, 0.02) * (0.6 + 0.8 * grain.g), 0.8 * mossy);
  #endif
  diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, uSnow * smoothstep(0.1, 0.4, skyward + 0.3 * (grain.r - 0.5)));
#endif
`;

export const LIGHT_GLSL = /* glsl */ `
#include <lights_fragment_end>
// The crowns above keep the blue of the sky from the forest floor.
reflectedLight.indirectDiffuse *= vec3(0.8, 0.72, 0.5);
#ifndef SOLID
reflectedLight.indirectDiffuse += diffuseColor.rgb * RECIPROCAL_PI * (0.06 * uSunColour + 0.14 * directLight.color)
  * vec3(1.05, 1.0, 0.6);
#endif
`;
