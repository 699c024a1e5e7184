/** Colour of the ground: leaf litter, meadow, snow. */
import { Color, MeshLambertMaterial } from "three";
import { GROUND_SHADE, GROUND_SHADE_PARS, groundShade } from "../impostors/groundShade";
import { SEASON_LOOKS, type Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { AIR_FRAGMENT, AIR_PARS, air } from "../sky/air";
import type { Pictures } from "../textures/pictures";

const PARS_GLSL = /* glsl */ `
varying vec3 vGround;
varying float vMeadow;
uniform sampler2D uNoise;
uniform sampler2D uLitter;
uniform sampler2D uGrass;
uniform float uBias; // of the level of detail of pictures
uniform vec3 uGrassTint;
uniform vec3 uLitterTint;
uniform float uFallen;
uniform float uSnow;
uniform vec3 uSnowColour;
`;

/**
 * Slope of the snow's surface, along x and z: drifts of some metres, drawn out along the prevailing wind, and ripples across it, some
 * centimetres high and a quarter of a metre long, where the wind has packed the snow. Both are assumed by eye.
 */
const SNOW_GLSL = /* glsl */ `
const vec2 BLOWN = vec2(0.866, 0.5); // direction of the presets of the wind
float drifted(vec2 place) {
  vec2 turned = vec2(dot(place, BLOWN), dot(place, vec2(-BLOWN.y, BLOWN.x)));
  return texture2D(uNoise, turned * vec2(0.008, 0.014) + 0.61).g;
}
vec2 snowSlope(vec2 place, float drift, float away) {
  const float STEP_M = 0.6;
  vec2 slope = vec2(drifted(place + vec2(STEP_M, 0.0)), drifted(place + vec2(0.0, STEP_M))) - drift;
  slope *= 1.2 / STEP_M;
  if (away < 26.0) {
    vec4 wavy = texture2D(uNoise, place * 0.045);
    float wave = dot(place, BLOWN) * 21.0 + 24.0 * wavy.r + 5.0 * wavy.b;
    float packed = smoothstep(0.4, 0.7, wavy.g) * (1.0 - smoothstep(8.0, 26.0, away));
    slope += BLOWN * packed * 0.085 * (cos(wave) + 0.4 * cos(2.0 * wave + 0.8));
  }
  return slope;
}
`;

const SNOW_NORMAL_GLSL = /* glsl */ `
#include <normal_fragment_begin>
if (uSnow > 0.0) {
  vec2 slope = uSnow * (1.0 - bare) * snowSlope(vGround.xz, drift, length(vViewPosition));
  normal = normalize(normal - (viewMatrix * vec4(slope.x, 0.0, slope.y, 0.0)).xyz);
}
`;

/**
 * Distances (m) from which on leaf litter and ragged edges fade into their mean, and are not read any more: their pictures repeat every
 * 5 m, and are one colour that far away.
 */
const COARSE_FROM_M = [45, 70] as const;
/** A picture whose share of the colour is less is not read. */
const LEAST_SHARE = 0.01;
/**
 * Pictures are read in branches that end where their share of the colour does, so that a wrong level of detail in the pixels along the
 * edge of a branch, whose neighbours skip it, is not seen. (Reading with gradients would be exact, but takes software rendering four
 * times as long.) Without anisotropic filtering the whole ground is blurred as the far side of a
 * pixel's footprint needs it: `uBias` makes it sharper, by the same everywhere, because a bias that varies is as slow as gradients.
 */
const COLOUR_GLSL = /* glsl */ `
vec2 g = vGround.xz;
float away = length(vViewPosition);
vec4 broad = texture2D(uNoise, g * 0.0043);
vec4 patchy = texture2D(uNoise, g * 0.021 + 0.37);
float fine = 1.0 - smoothstep(${COARSE_FROM_M[0].toFixed(1)}, ${COARSE_FROM_M[1].toFixed(1)}, away);
vec2 ragged = vec2(0.5); // its mean
vec2 atRagged = g * 0.19;
if (fine > 0.0) ragged = mix(ragged, texture2D(uNoise, atRagged).rg, fine);
float open = smoothstep(0.28, 0.72, vMeadow + 0.75 * (patchy.b - 0.5) + 0.3 * (broad.r - 0.5) + 0.55 * (ragged.g - 0.5));
// Without fallen leaves, grass and moss extend far into the forest.
open = max(open, (1.0 - uFallen) * smoothstep(0.1, 0.55, patchy.g + 0.6 * (ragged.r - 0.5)));
// Leaves blown onto the grass.
float grassy = open * (1.0 - smoothstep(0.62, 0.8, patchy.r) * 0.75 * uFallen);
vec2 atLitter = g * 0.21;
vec2 askew = mat2(0.8, 0.6, -0.6, 0.8) * g * 0.037;
vec2 atGrass = g * 0.16;
vec3 ground = vec3(0.0);
if (grassy < ${(1 - LEAST_SHARE).toFixed(2)}) {
  vec3 litter = texture2D(uLitter, askew, uBias).rgb;
  if (fine > 0.0) litter = mix(litter, texture2D(uLitter, atLitter, uBias).rgb, 0.65 * fine);
  ground = (1.0 - grassy) * litter * (0.85 + 0.6 * patchy.r) * uLitterTint;
}
if (grassy > ${LEAST_SHARE.toFixed(2)}) {
  vec3 grass = texture2D(uGrass, atGrass, uBias).rgb * (0.75 + 0.45 * patchy.g);
  vec3 meadow = mix(vec3(0.66, 0.9, 0.75), vec3(0.95, 0.95, 0.75), broad.g);
  float dry = smoothstep(0.42, 0.7, 0.55 * patchy.b + 0.25 * broad.b + 0.2 * ragged.r);
  meadow = mix(meadow, vec3(1.35, 1.02, 0.95), 0.55 * dry);
  ground += grassy * grass * meadow * uGrassTint;
}
float bare = 0.0;
float drift = 0.0;
if (uSnow > 0.0) {
  bare = 0.4 * (1.0 - open) * smoothstep(0.5, 0.75, patchy.r);
  // Hollows between the drifts see less of the sky.
  drift = drifted(g);
  ground = mix(ground, uSnowColour * (0.86 + 0.12 * patchy.b + 0.1 * drift), uSnow * (1.0 - bare));
}
${GROUND_SHADE}
diffuseColor.rgb = ground;
`;

const uniforms = {
  uGrassTint: { value: new Color() },
  uLitterTint: { value: new Color() },
  uFallen: { value: 1 },
};

/** Sets the colours of a season. */
export function setGroundSeason(season: Season): void {
  const { grass, litter, fallen } = SEASON_LOOKS[season];
  uniforms.uGrassTint.value.setRGB(...grass);
  uniforms.uLitterTint.value.setRGB(...litter);
  uniforms.uFallen.value = fallen;
}

export function groundMaterial(pictures: Pictures): MeshLambertMaterial {
  const material = new MeshLambertMaterial();
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, air, seasonal, uniforms, groundShade, {
      uNoise: { value: pictures.noise },
      uLitter: { value: pictures.litter },
      uGrass: { value: pictures.grass },
      uBias: pictures.groundBias,
    });
    const varyings = "attribute float aMeadow;\nvarying vec3 vGround;\nvarying float vMeadow;";
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${varyings}`)
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvGround = position;\nvMeadow = aMeadow;");
    shader.fragmentShader = shader.fragmentShader
      .replace(
        "#include <common>",
        `#include <common>\n${AIR_PARS}${PARS_GLSL}${SNOW_GLSL}${GROUND_SHADE_PARS}`,
      )
      .replace("#include <normal_fragment_begin>", SNOW_NORMAL_GLSL)
      .replace("#include <map_fragment>", COLOUR_GLSL)
      .replace("#include <opaque_fragment>", AIR_FRAGMENT)
      .replace("#include <fog_fragment>", "");
  };
  material.customProgramCacheKey = () => "galewood-ground";
  return material;
}
