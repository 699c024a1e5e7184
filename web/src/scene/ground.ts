/** The colour of the ground: leaf litter and meadow near by, the crowns of more woods at the horizon. */
import { MeshLambertMaterial } from "three";
import { AIR_FRAGMENT, AIR_PARS, air } from "./air";
import type { Pictures } from "./pictures";

const PARS = /* glsl */ `
varying vec3 vGround;
varying float vMeadow;
uniform sampler2D uNoise;
uniform sampler2D uLitter;
uniform sampler2D uGrass;
`;

const COLOUR = /* glsl */ `
vec2 g = vGround.xz;
vec4 broad = texture2D(uNoise, g * 0.0043);
vec4 patchy = texture2D(uNoise, g * 0.021 + 0.37);
vec3 litter = texture2D(uLitter, g * 0.21).rgb;
vec3 litterFar = texture2D(uLitter, mat2(0.8, 0.6, -0.6, 0.8) * g * 0.037).rgb;
litter = mix(litter, litterFar, 0.35) * (1.05 + 0.8 * patchy.r);
vec3 grass = texture2D(uGrass, g * 0.16).rgb * (0.8 + 0.45 * patchy.g);
grass *= mix(vec3(0.86, 1.0, 0.8), vec3(1.25, 1.05, 0.8), broad.g);
float open = smoothstep(0.28, 0.72, vMeadow + 0.75 * (patchy.b - 0.5) + 0.3 * (broad.r - 0.5));
vec3 ground = mix(litter, grass, open);
// Leaves that blew onto the grass.
ground = mix(ground, litter, open * smoothstep(0.62, 0.8, patchy.r) * 0.75);
float distant = smoothstep(140.0, 400.0, length(g));
if (distant > 0.0) {
  vec4 crowns = texture2D(uNoise, g * 0.011);
  vec3 woods = mix(vec3(0.36, 0.27, 0.06), vec3(0.40, 0.14, 0.04), smoothstep(0.45, 0.6, broad.b));
  woods = mix(woods, vec3(0.19, 0.23, 0.06), smoothstep(0.55, 0.7, broad.r));
  ground = mix(ground, woods * (0.3 + 1.3 * crowns.r * crowns.g + 0.3 * crowns.b), distant);
}
diffuseColor.rgb = ground;
`;

export function groundMaterial(pictures: Pictures): MeshLambertMaterial {
  const material = new MeshLambertMaterial();
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, air, {
      uNoise: { value: pictures.noise },
      uLitter: { value: pictures.litter },
      uGrass: { value: pictures.grass },
    });
    const varyings = "attribute float aMeadow;\nvarying vec3 vGround;\nvarying float vMeadow;";
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${varyings}`)
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvGround = position;\nvMeadow = aMeadow;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", `#include <common>\n${AIR_PARS}${PARS}`)
      .replace("#include <map_fragment>", COLOUR)
      .replace("#include <fog_fragment>", AIR_FRAGMENT);
  };
  material.customProgramCacheKey = () => "galewood-ground";
  return material;
}
