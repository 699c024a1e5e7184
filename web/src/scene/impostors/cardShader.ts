/** Shader code of impostors: a card that faces the eye, bends with its tree and is lit like it. */

import { LEAN_SHADER, NODE_TEXEL } from "galewood/trees";
import { AIR_FRAGMENT, AIR_PARS } from "../sky/air";
import { GRADIENT_NOISE } from "../treeSurface/leafColour";
import { CROWN_LIGHT } from "../treeSurface/treeLight";
import { COLOUR_VIEW } from "./baking/atlasLayout";
import { OCTAHEDRAL_GLSL } from "./baking/octahedral";
import { FLAT_VARYINGS, LIGHT_GLSL, NORMAL_GLSL, SURFACE_GLSL } from "./cardSurface";

/**
 * `SIMULATED`: the card follows two nodes of its own simulated tree. Otherwise its tip moves between two displacements.
 * `CASTS`: the card faces the sun, for the shadow maps.
 */
const VERTEX_PARS = /* glsl */ `
attribute vec4 aPlace; // x, y, z in m; opacity
attribute vec4 aTurn;  // scale*cos(yaw), scale*sin(yaw), scale, random number
attribute vec4 aTint;  // colour; weight relative to the texture colour
attribute vec4 aBend;  // texels of the middle and the tip; or displacement x, z of the tip before and after, m
uniform vec3 uBoxM;    // metres per unit across and up, height of the centre
uniform float uLean;   // 1: trees have a lean of their own
uniform vec3 uTree;    // reach in units, height in m, height of the middle node relative to it
uniform float uShare;
uniform float uExaggeration;
uniform vec3 uTowardsSun;
uniform sampler2D uLeafMap;
uniform float uMapped;
#ifdef SIMULATED
uniform highp usampler2D uNodes;
uniform int uNodeShift;
${NODE_TEXEL}
#endif
${FLAT_VARYINGS}
varying vec3 vCard;
varying vec3 vRay;
varying float vHeight;
${OCTAHEDRAL_GLSL}${LEAN_SHADER}
/** From the world to the tree's own frame, scale 1, and back, without its lean. */
vec3 inTree(vec3 world) {
  return vec3(aTurn.x * world.x - aTurn.y * world.z, aTurn.z * world.y, aTurn.y * world.x + aTurn.x * world.z)
    / (aTurn.z * aTurn.z);
}
vec3 inWorld(vec3 tree) {
  return vec3(aTurn.x * tree.x + aTurn.y * tree.z, aTurn.z * tree.y, aTurn.x * tree.z - aTurn.y * tree.x);
}
#ifdef SIMULATED
vec3 nodeAt(float texel) {
  return nodeMoved(nodeTexel(uNodes, int(texel + 0.5), uNodeShift));
}
#endif
/** Displacement (tree frame, m) at a height relative to the tree's: zero at the ground, as a parabola above. */
vec3 bendAt(float height) {
  float h = clamp(height, 0.0, 1.05);
  #ifdef SIMULATED
    vec3 middle = nodeAt(aBend.x);
    vec3 tip = nodeAt(aBend.y);
    vec3 curved = (tip - middle / uTree.z) / (1.0 - uTree.z);
    return h * (tip - curved) + h * h * curved;
  #else
    vec2 flat_ = mix(aBend.xy, aBend.zw, uShare);
    vec3 tip = inTree(vec3(flat_.x, 0.0, flat_.y));
    // Shape of the first mode of a tapered trunk, and the loss of height of a bent one.
    return tip * h * sqrt(h) - vec3(0.0, 0.5 * h * h * dot(tip, tip) / uTree.y, 0.0);
  #endif
}
`;

const POSITION_GLSL = /* glsl */ `
vec3 sunward = normalize(vec3(uTowardsSun.x, max(0.06, uTowardsSun.y), uTowardsSun.z));
vec3 span = vec3(uBoxM.x, uBoxM.y, uBoxM.x);
vec3 middleAt = vec3(0.0, uBoxM.z, 0.0);
#ifdef CASTS
  vec3 eye = 200.0 * normalize(inTree(sunward) / span);
#else
  vec3 eye = (inTree(cameraPosition - aPlace.xyz) - middleAt) / span;
#endif
vec3 towards = normalize(eye);
vec3 across = normalize(vec3(towards.z, 0.0, -towards.x) + vec3(1e-5, 0.0, 0.0));
vec3 upward = cross(towards, across);
// The card covers the tree as seen from here, with a margin for the perspective.
float most = 1.06 * uTree.x;
vec2 corner = position.xy * vec2(most, min(1.0, most * (abs(towards.y) + sqrt(1.0 - towards.y * towards.y))));
vec3 card = across * corner.x + upward * corner.y;
vec3 local = card * span + middleAt;
vHeight = local.y / uTree.y;
#ifdef SIMULATED
  local += bendAt(vHeight); // pass 1 has multiplied it
#else
  local += uExaggeration * bendAt(vHeight);
#endif
vec3 transformed = aPlace.xyz + inWorld(local);
transformed.xz += uLean * aTurn.z * local.y * leanOf(aPlace.xz);
vCard = card;
vRay = card - eye;
vCorner = cornerOf(towards);
vTint = aTint;
vMean = vec4(max(textureLod(uLeafMap, vec2(0.5), 10.0).rgb, 0.01), uMapped); // the coarsest mip level
vLook = vec2(aPlace.w, aTurn.w);
vTurn = aTurn.xy / aTurn.z;
vSunward = normalize(inTree(sunward) / span);
`;

/** A tree does not shade its own card, which lies in the middle of its crown: look for shadows in front of the crown. */
const RECEIVE_GLSL = /* glsl */ `
#include <shadowmap_vertex>
#if defined(USE_SHADOWMAP) && NUM_SUN_LIGHT_SHADOWS > 0
  vSunShadowWorldPosition.xyz += 1.7 * uBoxM.x * uTree.x * aTurn.z * sunward;
#endif
`;

const FRAGMENT_PARS = /* glsl */ `
uniform sampler2D uColour;
uniform sampler2D uSurface;
uniform float uBare;
uniform float uCrowded;
uniform float uSnow;
uniform vec3 uSnowColour;
uniform float uEdge;
uniform vec3 uBoxM; // as above
uniform vec3 uSunColour;
uniform vec3 uSkyColour;
${FLAT_VARYINGS}
varying vec3 vCard;
varying vec3 vRay;
varying float vHeight;
${OCTAHEDRAL_GLSL}
${GRADIENT_NOISE}
vec3 fromOctahedron(vec2 folded) {
  vec3 n = vec3(folded.y, 1.0 - abs(folded.x) - abs(folded.y), folded.x);
  float under = max(-n.y, 0.0);
  n.x += n.x >= 0.0 ? -under : under;
  n.z += n.z >= 0.0 ? -under : under;
  return normalize(n);
}
float corner_(vec2 at) {
  vec3 p = fract(vec3(at.xyx) * 0.1031);
  p += dot(p, p.yzx + 33.33);
  return fract((p.x + p.y) * p.z);
}
/** Smooth noise between 0 and 1. */
float tuft(vec2 at) {
  vec2 f = fract(at);
  f *= f * (3.0 - 2.0 * f);
  vec2 i = floor(at);
  return mix(mix(corner_(i), corner_(i + vec2(1.0, 0.0)), f.x),
    mix(corner_(i + vec2(0.0, 1.0)), corner_(i + vec2(1.0, 1.0)), f.x), f.y);
}
struct Seen { vec4 colour; vec4 surface; vec3 at; };
/** What the ray through a point of the card meets, in one of the three views around it. */
Seen look(float chance) {
  vec2 view = chooseView(vCorner, chance);
  vec3 towards = viewAt(view);
  vec3 across = normalize(vec3(towards.z, 0.0, -towards.x));
  vec3 upward = cross(towards, across);
  // The mean of both directions: a pixel covers fewer texels of a slender tree upwards than across.
  const float TEXELS = ${((COLOUR_VIEW.width * COLOUR_VIEW.height) / 4).toFixed(1)};
  float lod = 0.5 * log2(sqrt(dot(dFdx(vCard), dFdx(vCard)) * dot(dFdy(vCard), dFdy(vCard))) * TEXELS);
  // Begin at the upright plane through the axis, where the trunk is.
  vec3 ray = normalize(vRay);
  vec2 level = normalize(towards.xz);
  vec3 from = vCard + clamp(-dot(vCard.xz, level) / min(-0.3, dot(ray.xz, level)), -0.8, 0.8) * ray;
  vec2 q = vec2(dot(from, across), dot(from, upward));
  // The depth of tufts, not of leaves: if leaves beside each other moved by different ways, they would be smeared.
  float depth = 2.0 * textureLod(uSurface, (view + clamp(0.5 + 0.5 * q, 0.01, 0.99)) / VIEWS, max(2.0, lod - 1.0)).z - 1.0;
  float way = clamp((depth - dot(vCard, towards)) / min(-0.3, dot(ray, towards)), -1.0, 1.0);
  vec3 at = vCard + way * ray;
  q = clamp(vec2(dot(at, across), dot(at, upward)), -0.98, 0.98);
  vec2 place = (view + 0.5 + 0.5 * q) / VIEWS;
  vec4 colour = textureLod(uColour, place, lod);
  colour.rgb /= max(colour.a, 0.02);
  if (lod < 0.4) {
    // Near the eye the picture is coarser than the screen: add leaves at its edges and in its light.
    vec2 fine_m = vec2(dot(at, across) * uBoxM.x, dot(at, upward) * length(upward * uBoxM.xyx));
    float leaf = 0.55 * tuft(fine_m / 0.21) + 0.45 * tuft(fine_m / 0.09 + 7.0);
    float amount = clamp(0.25 - 0.6 * lod, 0.0, 1.0);
    colour.a += amount * 1.5 * (leaf - 0.5) * step(0.01, colour.a);
    colour.rgb *= 1.0 + amount * 0.8 * (leaf - 0.5);
  }
  // Mip levels reduce the coverage of leaves and twigs: restore it.
  colour.a *= 1.0 + mix(0.12, 0.3, uBare) * clamp(lod + 1.0, 0.0, 4.0);
  return Seen(colour, textureLod(uSurface, place, lod - 1.0), at);
}
`;

/** Corners of the card, and its cut-out. */
const CUT_GLSL = /* glsl */ `
float noise = gradientNoise(gl_FragCoord.xy);
if (vLook.x < 0.999 && vLook.x <= gradientNoise(gl_FragCoord.xy + 71.0)) discard;
Seen seen = look(corner_(gl_FragCoord.xy));
float leafy = smoothstep(0.44, 0.56, seen.surface.w);
// Thin twigs cover less than a pixel: keep some of their pixels, at random.
float cut = mix(uEdge, 0.12 + 0.5 * fract(noise + 0.5 * vLook.y), mix(0.12, 1.0, uBare));
seen.colour.a *= 1.0 - uBare * leafy;
if (seen.colour.a < cut) discard;
`;

/** Changes three's Lambert shader. */
export function patchCard(shader: { vertexShader: string; fragmentShader: string }, defines: string): void {
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", `#include <common>\n${defines}${VERTEX_PARS}`)
    .replace("#include <beginnormal_vertex>", "vec3 objectNormal = vec3(0.0, 1.0, 0.0);")
    .replace("#include <begin_vertex>", POSITION_GLSL)
    .replace("#include <shadowmap_vertex>", RECEIVE_GLSL);
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <common>", `#include <common>\n${AIR_PARS}${CROWN_LIGHT}${FRAGMENT_PARS}`)
    .replace("#include <map_fragment>", CUT_GLSL + SURFACE_GLSL)
    .replace("#include <alphatest_fragment>", "")
    .replace("#include <normal_fragment_begin>", NORMAL_GLSL)
    .replace("#include <lights_fragment_end>", LIGHT_GLSL)
    .replace("#include <opaque_fragment>", AIR_FRAGMENT)
    .replace("#include <fog_fragment>", "");
}

/** Changes three's depth shader: the card as the sun sees it. */
export function patchShadow(shader: { vertexShader: string; fragmentShader: string }, defines: string): void {
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", `#include <common>\n${defines}#define CASTS\n${VERTEX_PARS}`)
    .replace("#include <begin_vertex>", POSITION_GLSL);
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <common>", `#include <common>\n${FRAGMENT_PARS}`)
    .replace("#include <map_fragment>", CUT_GLSL)
    .replace("#include <alphatest_fragment>", "");
}
