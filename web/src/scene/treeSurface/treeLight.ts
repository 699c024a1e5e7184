/** Colour and light of trees: the fragment part of pass 2. */

import { type Part, UNMAPPED_BELOW } from "galewood/trees";
import type { Color, WebGLProgramParametersWithUniforms } from "three";
import { BLADE_NORMAL } from "./closeShader";
import { LEAF_COVER, LEAF_MAP, SHOOT_COPY, SPRAY_MOTION, UNDERSIDES } from "./leafColour";
import { ONE_SHADOW_SAMPLE } from "./leafShadow";

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

/** Atmospheric perspective, as shader code that the scene supplies. */
export interface AtmosphereShader {
  /** Part of the program's cache key: differs where the code differs. */
  readonly key: string;
  readonly uniforms: Readonly<Record<string, { value: unknown }>>;
  /** GLSL declarations and functions for both shaders. */
  readonly declarations: string;
  /** GLSL for the vertex shader, once `vViewPosition` is known. */
  readonly atVertex: string;
  /** Replaces three's `opaque_fragment`; works on linear light before tone mapping. */
  readonly output: string;
}

const FRAGMENT_PARS = /* glsl */ `
uniform float uSnow;
uniform vec3 uSnowColour;
uniform vec3 uSunColour;
uniform vec3 uSkyColour;
uniform float uLeafShare;
varying vec4 vTint;
varying vec4 vPiece;
#ifdef SINGLE_LEAVES
varying vec3 vBlade; // normal of a blade, without that of the crown
#endif
`;

/** Colour of soil and wet litter on the foot of a stem, linear light (by eye, between dark soil and leaf litter). */
const SOIL_RGB = "vec3(0.075, 0.042, 0.018)";

/**
 * Bark. The third number of its piece is the soil on it, up to 1 and more at the ground (addedWood.ts): there the bark takes the
 * colour of the ground with a ragged edge, so that the line in which a polygon meets the ground is not seen.
 */
const WOOD_MAP = /* glsl */ `
// Of merged parts bark has pictures, twigs have none, and vertices have the colours of the materials (mergedParts.ts).
bool barked = true;
#ifdef MERGED
  diffuseColor.rgb *= vColor.rgb;
  #undef USE_COLOR // not once more
  #ifdef USE_NORMALMAP
    barked = vNormalMapUv.x > ${UNMAPPED_BELOW.toFixed(1)};
  #endif
  #ifdef USE_MAP
    barked = vMapUv.x > ${UNMAPPED_BELOW.toFixed(1)};
    vec4 picture = texture2D(map, vMapUv); // not in the branch, where its gradient would be undefined
    if (barked) diffuseColor *= picture;
  #endif
#else
  #include <map_fragment>
#endif
// Darken pale bark, which would be white in sunlight.
diffuseColor.rgb *= (0.85 + 0.3 * vPiece.x) * (1.0 - 0.5 * diffuseColor.g);
if (vPiece.z > 0.0) {
  #ifdef USE_MAP
    vec2 spot = vMapUv;
  #else
    vec2 spot = vec2(0.0);
  #endif
  float rough = 0.6 * sin(17.0 * spot.x + 3.0 * sin(31.0 * spot.y)) + 0.4 * sin(83.0 * spot.x - 97.0 * spot.y + 4.0 * sin(29.0 * spot.x));
  float soil = smoothstep(0.0, 0.8, vPiece.z + 0.07 * rough);
  diffuseColor.rgb = mix(diffuseColor.rgb, ${SOIL_RGB} * (0.9 + 1.2 * diffuseColor.g + 0.3 * rough), 0.93 * soil);
}
`;

/** Distances (m) up to which bark has its whole relief, and from which on it has none and its picture is not read. */
const RELIEF_M = [12, 24] as const;

/**
 * Relief of bark near the eye, in the frame that three.js derives from the gradients of places and texture coordinates. Those of
 * the picture are taken before the branch, in which they would be undefined.
 */
const WOOD_NORMAL = /* glsl */ `
#ifdef USE_NORMALMAP_TANGENTSPACE
  float relief = 1.0 - smoothstep(${RELIEF_M[0].toFixed(1)}, ${RELIEF_M[1].toFixed(1)}, length(vViewPosition));
  vec2 barkRight = dFdx(vNormalMapUv);
  vec2 barkDown = dFdy(vNormalMapUv);
  if (barked && relief > 0.0) {
    vec3 bark = textureGrad(normalMap, vNormalMapUv, barkRight, barkDown).xyz * 2.0 - 1.0;
    bark.xy *= relief * normalScale;
    normal = normalize(tbn * bark);
    diffuseColor.rgb *= mix(1.0, smoothstep(0.2, 1.0, bark.z / length(bark)), 0.5 * relief); // furrows see less of the sky
  }
#endif
`;

/**
 * Snow in patches on wood that faces the sky. On a bough it lies as a cap that hides its flanks, too, which a stem's do not hold: the axis of
 * the wood is perpendicular to the normal and to the change of the normal.
 */
const SNOW_GLSL = /* glsl */ `
if (uSnow > 0.0) {
  vec3 upwards = (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz;
  vec3 smoothed = normalize(vNormal);
  vec3 turningX = dFdx(smoothed);
  vec3 turningY = dFdy(smoothed);
  vec3 axis = cross(smoothed, dot(turningX, turningX) > dot(turningY, turningY) ? turningX : turningY);
  float bough = 1.0 - smoothstep(0.5, 0.9, abs(dot(axis, upwards)) / max(1e-6, length(axis)));
  float from = mix(0.05, -0.3, length(axis) > 1e-5 ? bough : 0.0);
  float lying = smoothstep(from, from + 0.4, dot(normal, upwards) + 0.35 * (fract(vPiece.x * 7.0) - 0.6));
  diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, lying * uSnow);
}
`;

/**
 * GLSL of the share of snow on needles: shoots on all sides of a crown hold some, fewer the more they face down. The normals are those
 * of the crown, so by them alone only its top would be white. `skyward`: the upward part of the normal; `random`: of the shoot, 0..1.
 */
export const snowOnNeedles = (skyward: string, random: string): string =>
  `0.8 * smoothstep(0.35, 0.95, 0.36 + 0.16 * ${skyward} + 0.75 * ${random})`;

/** Thickness of the snow on shoots, m. */
const SHOOT_SNOW_M = 0.05;

/** Snow on the upper edges of shoots: where the picture has a gap just above. Without a picture, on whole pieces. */
const LEAF_SNOW = /* glsl */ `
if (uSnow > 0.0) {
  float skyward = dot(normal, (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz);
  float lying = ${snowOnNeedles("skyward", "fract(vPiece.x * 7.0)")};
  #ifdef USE_MAP
    float pixels = clamp(${SHOOT_SNOW_M} / max(1e-4, length(dFdy(vViewPosition))), 1.0, 60.0);
    float gap = 1.0 - smoothstep(0.15, 0.6, textureGrad(map, leafUv + pixels * down / texels, right / texels, down / texels).a);
    lying = min(0.95, 0.35 * lying + 0.85 * gap * smoothstep(-1.3, 0.2, skyward));
  #endif
  diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, lying * uSnow);
}
`;

/** A leaf has so many times as many texels in its own tile as in that of its spray. */
const SINGLE_TEXELS = 12;

const LEAF_NORMAL = /* glsl */ `
float faceDirection = gl_FrontFacing ? 1.0 : -1.0;
vec3 normal = normalize(vNormal); // crown normals: the same from both sides
vec3 nonPerturbedNormal = normal;
#if defined(CUTICLE) && defined(USE_MAP)
  // Near the eye: the plane of the card, with ribs and edges of the leaves from the gradient of the picture's lightness.
  vec3 along = normalize(dFdx(vViewPosition));
  vec3 across = normalize(dFdy(vViewPosition));
  #ifdef SINGLE_LEAVES
    vec3 face = normalize(vBlade);
    face = faceforward(face, -vViewPosition, face);
    float close = 1.0 - smoothstep(2.0, 60.0, area / ${SINGLE_TEXELS.toFixed(1)});
  #else
    vec3 face = normalize(cross(along, across));
    float close = 1.0 - smoothstep(2.0, 60.0, area);
  #endif
  vec3 relief = dFdx(shade) * cross(across, face) + dFdy(shade) * cross(face, along);
  vec3 blade = normalize(face - 2.2 * close * relief);
  normal = normalize(mix(normal, faceforward(blade, -normal, blade), 0.4 * close));
#endif
`;

/**
 * Light of the sky on stems, by eye: the leaves around a stem keep the sky's blue from it. And the sky is brighter near the sun, which
 * models a stem in shade: without the sun itself, a wall that faces it gets about 1.7 times as much as one that turns from it.
 */
const STEM_SKY_RGB = "vec3(1.02, 0.93, 0.72)";
const STEM_SKY_SIDED = 0.26;
/** So is the light of the sky inside a crown, where it comes through and from other leaves: without it, spruces in shade are blue. */
const LEAF_SKY_RGB = "vec3(1.04, 0.97, 0.62)";

/**
 * Light inside a crown, where neither the shadow map nor the hemisphere light know how much reaches a leaf: part of the
 * sky is visible everywhere, and sunlight is scattered on from leaf to leaf, most on the sunny side.
 */
export const CROWN_LIGHT = /* glsl */ `
/** Share of the sky light at an openness (0 inside the crown, 1 outside). */
float crownSky(float open) {
  return 0.58 + 0.42 * open;
}
/** Factor of the sky light on leaves. */
vec3 leafSky(float open) {
  return crownSky(open) * mix(${LEAF_SKY_RGB}, vec3(1.0), open);
}
/** Share of the sun that finds gaps: a low one meets more crowns on its way. high: sine of its elevation. */
float crownGaps(float high) {
  return 0.3 + 0.7 * smoothstep(0.05, 0.55, high);
}
/** Irradiance by sunlight that other leaves scattered; facing: cosine between the crown's normal and the sun. */
vec3 crownGlow(vec3 sun, float open, float facing) {
  return sun * vec3(0.7, 1.0, 0.5) * (0.045 + 0.085 * smoothstep(-1.0, 0.7, facing)) * (0.5 + 0.5 * open);
}
/** Factor of the sky light on wood; facing: cosine between its normal and the sun. */
vec3 stemSky(float inLeaf, float facing) {
  return mix(vec3(1.0), ${STEM_SKY_RGB}, inLeaf) * (1.0 + ${STEM_SKY_SIDED} * facing);
}
/** Light that passes a leaf over light that it reflects: a green leaf passes more green and less red and blue, a red or yellow one its red. */
vec3 passedColour(vec3 leaf) {
  return mix(vec3(1.12, 1.0, 0.5), vec3(0.95, 1.08, 0.4), smoothstep(0.0, 0.3, 1.0 - leaf.r / max(leaf.g, 1e-4)));
}
`;

/** Level of a leaf picture at which veins are blurred and leaves are not yet. */
const BESIDE_VEINS_LEVEL = 4;

/** Gloss of a spray of needles relative to a leaf: they face all ways, but the card that shows them faces one (by eye). */
const NEEDLE_SHINE = 0.2;

/** After lighting: light inside the crown, light through the leaves, and the gloss of their cuticle. */
const LEAF_LIGHT = /* glsl */ `
#include <lights_fragment_end>
vec3 skyward_ = (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz;
float facingSun = dot(geometryNormal, directLight.direction);
float gaps = crownGaps(dot(directLight.direction, skyward_));
reflectedLight.indirectDiffuse *= leafSky(vPiece.y);
reflectedLight.directDiffuse *= 0.6 + 0.4 * vPiece.y;
vec3 leafTint = diffuseColor.rgb * RECIPROCAL_PI;
reflectedLight.indirectDiffuse += leafTint * gaps * crownGlow(uSunColour, vPiece.y, facingSun);
// Through the leaf: the sun, of which some passes between the leaves that a shadow map merges, and the sky above it.
float through = pow(saturate(dot(-geometryViewDir, directLight.direction)), 3.0);
float behind = saturate(0.45 - 0.55 * facingSun);
float beneath = saturate(0.2 - 0.8 * dot(geometryViewDir, skyward_)); // leaves face all ways
// Veins, which are lighter than the blade beside them, pass less.
float thin = 1.0;
#if defined(CUTICLE) && defined(USE_MAP)
  vec3 beside = textureLod(map, leafUv, ${BESIDE_VEINS_LEVEL.toFixed(1)}).rgb;
  thin -= close * min(0.5, 1.6 * max(0.0, picture / max(0.01, dot(beside, vec3(0.2126, 0.7152, 0.0722))) - 1.06));
#endif
vec3 passed = mix(directLight.color, uSunColour, 0.22 * gaps) * (0.35 + 0.65 * vPiece.y) * (0.6 * through + 0.34 * behind)
  + uSkyColour * leafSky(vPiece.y) * 0.7 * beneath;
reflectedLight.directDiffuse += leafTint * thin * passed * passedColour(diffuseColor.rgb);
#if defined(CUTICLE) && defined(USE_MAP)
  // Fresnel reflection of a waxy leaf (refractive index about 1.45), smoother on some leaves than on others.
  float gloss = mix(9.0, 48.0, fract(vPiece.x * 13.7)) * (0.4 + 0.6 * close);
  vec3 shiny = faceforward(blade, -geometryViewDir, blade);
  vec3 halfway = normalize(geometryViewDir + directLight.direction);
  float grazing = pow(1.0 - saturate(dot(geometryViewDir, shiny)), 5.0);
  float glint = pow(saturate(dot(shiny, halfway)), gloss) * (gloss + 8.0) / 25.1;
  #ifdef EVERGREEN
    const float shine = ${NEEDLE_SHINE.toFixed(2)};
  #else
    const float shine = 1.0;
  #endif
  reflectedLight.directDiffuse += shine * directLight.color * saturate(dot(shiny, directLight.direction)) * glint
    * (0.035 + 0.965 * pow(1.0 - saturate(dot(halfway, geometryViewDir)), 5.0));
  reflectedLight.indirectDiffuse += shine * uSkyColour * RECIPROCAL_PI * vPiece.y * (0.03 + 0.3 * grazing)
    * saturate(0.35 + 0.65 * dot(reflect(-geometryViewDir, shiny), skyward_));
#endif
`;

const WOOD_LIGHT = /* glsl */ `
#include <lights_fragment_end>
reflectedLight.indirectDiffuse *= crownSky(vPiece.y) * stemSky(uLeafShare, dot(geometryNormal, directLight.direction));
reflectedLight.indirectDiffuse += diffuseColor.rgb * RECIPROCAL_PI * 0.7
  * crownGaps(dot(directLight.direction, (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz))
  * crownGlow(uSunColour, vPiece.y, dot(geometryNormal, directLight.direction));
`;

/** Adds colour, snow and light to the fragment shader of a part. */
export function patchColour(
  shader: WebGLProgramParametersWithUniforms,
  part: Part,
  moves: boolean,
  atmosphere: AtmosphereShader,
): void {
  const leaves = part === "leaves";
  const sprays =
    leaves && moves
      ? `uniform vec2 uFlutter;\nuniform float uLeafHz;\n#if defined(CUTICLE) && !defined(SINGLE_LEAVES)\n#define SPRAYS\n${SPRAY_MOTION}#endif\n`
      : "";
  shader.fragmentShader = shader.fragmentShader
    .replace(
      "#include <common>",
      `#include <common>\n${FRAGMENT_PARS}${CROWN_LIGHT}${LEAF_COVER}${SHOOT_COPY}${sprays}${atmosphere.declarations}`,
    )
    .replace("#include <map_fragment>", leaves ? LEAF_MAP + (moves ? UNDERSIDES : "") : WOOD_MAP)
    .replace("#include <lights_fragment_end>", leaves ? LEAF_LIGHT : WOOD_LIGHT)
    .replace("#include <normal_fragment_maps>", leaves ? LEAF_SNOW : WOOD_NORMAL + SNOW_GLSL)
    .replace("#include <opaque_fragment>", atmosphere.output)
    .replace("#include <fog_fragment>", "");
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", `#include <common>\n${atmosphere.declarations}`)
    .replace("#include <defaultnormal_vertex>", leaves ? BLADE_NORMAL : "#include <defaultnormal_vertex>")
    .replace("#include <fog_vertex>", atmosphere.atVertex);
  if (!leaves) return;
  const pars = "#include <shadowmap_pars_fragment>";
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <normal_fragment_begin>", LEAF_NORMAL)
    .replace(pars, pars + ONE_SHADOW_SAMPLE);
}
