/** The map of tree shadows as a texture, for the ground beyond the shadow maps. */
import { DataTexture, LinearFilter, NoColorSpace, RedFormat, Vector3 } from "three";
import { SHADE_M, SHADE_SIDE, shadeOf } from "./shadeMap";

const map = new Uint8Array(SHADE_SIDE * SHADE_SIDE);

/** Uniforms for the ground. */
export const groundShade = {
  uShade: { value: new DataTexture(map, SHADE_SIDE, SHADE_SIDE, RedFormat) },
  /** Distances from the eye between which the map replaces the shadow maps, m; light that a crown holds back. */
  uShadeFrom: { value: new Vector3(1e9, 2e9, 1) },
};
groundShade.uShade.value.colorSpace = NoColorSpace;
groundShade.uShade.value.magFilter = LinearFilter;
groundShade.uShade.value.minFilter = LinearFilter;
groundShade.uShade.value.needsUpdate = true;

export const GROUND_SHADE_PARS = /* glsl */ `
uniform sampler2D uShade;
uniform vec3 uShadeFrom;
`;

/** Needs the position on the ground, `g`, and darkens `ground`. */
export const GROUND_SHADE = /* glsl */ `
float shaded = texture2D(uShade, g / ${SHADE_M.toFixed(1)} + 0.5).r;
float beyond = smoothstep(uShadeFrom.x, uShadeFrom.y, length(vViewPosition));
ground *= 1.0 - uShadeFrom.z * shaded * mix(0.12, 0.62, beyond) * vec3(1.0, 0.96, 0.88);
`;

/** Draws the shadows of these trees (x, z, height, radius) in the light of this sun. */
export function castShade(trees: Float32Array, sun: { x: number; y: number; z: number }): void {
  shadeOf(trees, sun, map);
  groundShade.uShade.value.needsUpdate = true;
}
