/** Aerial perspective in linear light, before tone mapping; sky, ground and trees share one sky table. */
import { Color, type DataTexture, Vector2, Vector3 } from "three";
import type { AtmosphereShader } from "../treeSurface/treeLight";
import { AEROSOL_G, SKY_AZIMUTHS, SKY_ELEVATIONS } from "./atmosphere";

export const air = {
  /** Sky table, see skyTexture.ts. */
  uSky: { value: null as DataTexture | null },
  /** Direction towards the sun, world frame. */
  uSunWorld: { value: new Vector3(0.5, 0.5, 0.5).normalize() },
  /** Its horizontal direction, unit length. */
  uSunFlat: { value: new Vector2(0.7, 0.7) },
  /** Extinction per metre for each colour. */
  uHaze: { value: new Color(0.0007, 0.0009, 0.0013) },
  /** How far eyes see as by night, when they tell no colours apart: 0 by day, 1 by night. */
  uNightVision: { value: 0 },
  /** Ground mist: extinction per metre at its base, height of the base (m), scale height (m). */
  uMist: { value: new Vector3(0, -4, 7) },
};

const halfTexel = (count: number) => (0.5 / count).toFixed(6);
const inner = (count: number) => (1 - 1 / count).toFixed(6);

/**
 * Part of its light that the air among trees lacks, because they shade it: with the sun at the horizon, and high (assumed; it keeps the
 * contrast of a wood, and its shade from being blue). It fades with the height of the path above the base of the mist, and with its length, m.
 */
const SHADED_AIR = [0.65, 0.45] as const;
const SHADED_BELOW_M = [14, 30] as const;
const SHADED_WITHIN_M = [150, 700] as const;

/**
 * By night, rods see: more of blue and green light than of red, and no colours (Purkinje shift; weights and the bluish grey by eye). Some
 * colour is left.
 */
const ROD_SENSITIVITY_RGB = [0.06, 0.57, 0.37] as const;
const NIGHT_HUE_RGB = [0.75, 0.98, 1.4] as const;
const GREY_BY_NIGHT = 0.7;

const glslRgb = (rgb: readonly number[]) => `vec3(${rgb.map((value) => value.toFixed(3)).join(", ")})`;
const glslRange = ([from, to]: readonly [number, number]) => `${from.toFixed(2)}, ${to.toFixed(2)}`;

export const AIR_PARS = /* glsl */ `
uniform sampler2D uSky;
uniform vec3 uSunWorld;
uniform vec2 uSunFlat;
uniform vec3 uHaze;
uniform vec3 uMist;
uniform float uNightVision;
float aerosolPhase(float cosine) {
  const float g = ${AEROSOL_G.toFixed(3)};
  return (1.0 - g * g) * 0.0795775 * pow(1.0 + g * g - 2.0 * g * cosine, -1.5);
}
/** Light of the clear sky; root: square root of the elevation divided by 90 degrees. */
vec3 skyLight(vec2 flatDirection, float root, float cosine) {
  float turn = sqrt(0.5 * max(0.0, 1.0 - dot(flatDirection, uSunFlat)));
  vec2 at = vec2(${halfTexel(SKY_AZIMUTHS)} + ${inner(SKY_AZIMUTHS)} * turn,
    0.5 * (${halfTexel(SKY_ELEVATIONS)} + ${inner(SKY_ELEVATIONS)} * root));
  return texture2D(uSky, at).rgb + aerosolPhase(cosine) * texture2D(uSky, at + vec2(0.0, 0.5)).rgb;
}
/** Colour of distant haze in a direction. */
vec3 hazeColour(vec3 direction) {
  vec2 level = normalize(direction.xz + 1e-5);
  float cosine = dot(normalize(vec3(level.x, 0.07, level.y)), uSunWorld);
  return skyLight(level, 0.2, min(cosine, 0.97));
}
/** Optical depth of the mist up to a distance. */
float mistDepth(vec3 direction, float away) {
  float foot = exp(-max(-3.0, (cameraPosition.y - uMist.y) / uMist.z));
  float climb = direction.y * away / uMist.z;
  float mean = abs(climb) < 0.001 ? 1.0 : (1.0 - exp(-clamp(climb, -6.0, 60.0))) / climb;
  return uMist.x * foot * away * mean;
}
const vec3 ROD_SENSITIVITY = ${glslRgb(ROD_SENSITIVITY_RGB)};
const vec3 NIGHT_HUE = ${glslRgb(NIGHT_HUE_RGB)};
vec3 seenByNight(vec3 colour) {
  return mix(colour, dot(colour, ROD_SENSITIVITY) * NIGHT_HUE, ${GREY_BY_NIGHT} * uNightVision);
}
/** Air up to a distance: the share of the light from there that passes, and the light that the air adds. */
void airUpTo(vec3 direction, float away, out vec3 clear, out vec3 added) {
  clear = exp(-uHaze * away);
  vec3 haze = hazeColour(direction);
  float height = cameraPosition.y + 0.5 * direction.y * away - uMist.y;
  float dimmed = mix(${glslRange(SHADED_AIR)}, smoothstep(0.1, 0.6, uSunWorld.y));
  dimmed *= (1.0 - smoothstep(${glslRange(SHADED_BELOW_M)}, height)) * (1.0 - smoothstep(${glslRange(SHADED_WITHIN_M)}, away));
  added = (1.0 - dimmed) * haze * (1.0 - clear);
  if (uMist.x > 0.0) {
    float passed = exp(-mistDepth(direction, away));
    clear *= passed;
    added = mix(haze, added, passed);
  }
}
vec3 throughAir(vec3 colour, vec3 direction, float away) {
  vec3 clear, added;
  airUpTo(direction, away, clear, added);
  return seenByNight(clear * colour + added);
}
`;

/** Replaces three's end of the fragment shader, before tone mapping; needs vViewPosition. */
export const AIR_FRAGMENT = /* glsl */ `
#include <opaque_fragment>
vec3 airDirection = -normalize((vec4(vViewPosition, 0.0) * viewMatrix).xyz);
gl_FragColor.rgb = throughAir(gl_FragColor.rgb, airDirection, length(vViewPosition));
`;

const AIR_VARYINGS = /* glsl */ `
varying vec3 vAirClear;
varying vec3 vAirAdded;
`;

/**
 * The same for trees. Their triangles are so small that the air is computed at their vertices; at each pixel of leaves it took a quarter of
 * their time where the processor draws.
 */
export const aerialPerspective: AtmosphereShader = {
  key: "air",
  uniforms: air,
  declarations: AIR_PARS + AIR_VARYINGS,
  atVertex:
    "airUpTo(-normalize((vec4(vViewPosition, 0.0) * viewMatrix).xyz), length(vViewPosition), vAirClear, vAirAdded);",
  output: /* glsl */ `
#include <opaque_fragment>
gl_FragColor.rgb = seenByNight(vAirClear * gl_FragColor.rgb + vAirAdded);
`,
};
