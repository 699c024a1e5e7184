/**
 * Grass tufts around the camera, on a lattice that wraps around it, so that tufts stay in place while the camera moves.
 * They bend with the wind.
 */

import { hashUnit, valueNoise } from "galewood/random";
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  InstancedBufferGeometry,
  Mesh,
  MeshLambertMaterial,
  Vector2,
  Vector3,
} from "three";
import type { Quality } from "../quality";
import { SEASON_LOOKS, type Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { AIR_FRAGMENT, AIR_PARS, air } from "../sky/air";
import { BLADE_GLSL, GROUND_WIND_PARS, type GroundWind } from "./groundWind";
import { glade, groundHeight_m } from "./landscape";
import { PlantField } from "./plantField";

const COVER_FIELDS: Record<Quality, { side: number; spacing_m: number }> = {
  low: { side: 56, spacing_m: 0.85 },
  medium: { side: 96, spacing_m: 0.62 },
  high: { side: 176, spacing_m: 0.46 },
};
const BLADE_COUNT = 7;

/** A tuft of bent blades around the origin, each of three triangles and with a pointed tip; y runs from 0 to 1. */
function tuft(): BufferGeometry {
  const position: number[] = [];
  const index: number[] = [];
  for (let blade = 0; blade < BLADE_COUNT; blade++) {
    const at = (channel: number) => hashUnit(61, blade, channel);
    const angle = (blade / BLADE_COUNT + 0.1 * at(0)) * 2 * Math.PI;
    const [out, across] = [new Vector2(Math.cos(angle), Math.sin(angle)), 0.055 + 0.03 * at(1)];
    const lean = 0.25 + 0.5 * at(2);
    const tall = 0.6 + 0.4 * at(3);
    const first = position.length / 3;
    for (const [level, share] of [
      [0, 1],
      [0.55, 0.75],
    ]) {
      const r = 0.08 + lean * level * level;
      for (const side of [-0.5, 0.5]) {
        const w = side * across * share;
        position.push(r * out.x - w * out.y, tall * level, r * out.y + w * out.x);
      }
    }
    const r = 0.08 + lean;
    position.push(r * out.x, tall, r * out.y);
    index.push(first, first + 1, first + 2, first + 1, first + 3, first + 2, first + 2, first + 3, first + 4);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(position), 3));
  const up = Float32Array.from(position, (_, i) => (i % 3 === 1 ? 1 : 0));
  geometry.setAttribute("normal", new BufferAttribute(up, 3));
  geometry.setIndex(index);
  return geometry;
}

const VERTEX_PARS = /* glsl */ `
attribute vec4 aPlant; // x, y, z in m; size
attribute vec4 aLook; // random number, dryness, width, flower
uniform float uSeconds;
uniform vec3 uEye;
uniform float uReach;
varying float vUp;
varying vec4 vLook;
${GROUND_WIND_PARS}${BLADE_GLSL}`;

const POSITION_GLSL = /* glsl */ `
float near = 1.0 - smoothstep(0.7, 1.0, distance(aPlant.xz, uEye.xz) / uReach);
float turn = aLook.x * 6.2832;
vec2 spun = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * position.xz * aLook.z;
vec2 along = leanAt(aPlant.xz);
float strength = length(along);
// A blade bends the more the higher up, keeps its length, and trembles in its own eddies.
float lean = bladeLean(strength, aLook.x, uSeconds) * position.y;
vec2 bow = along / max(strength, 1e-4) * sin(lean) * position.y;
float size = aPlant.w * near;
vec3 transformed = aPlant.xyz + size * vec3(spun.x + bow.x, position.y * cos(lean), spun.y + bow.y);
vUp = position.y;
vLook = aLook;
`;

const COLOUR_GLSL = /* glsl */ `
vec3 green = mix(vec3(0.125, 0.185, 0.042), vec3(0.36, 0.31, 0.11), vLook.y) * uGrassTint;
diffuseColor.rgb = green * (0.3 + 0.9 * vUp) * (0.8 + 0.4 * vLook.x);
// Ears of old blades, and flowers.
diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.4, 0.3, 0.14), 0.6 * vLook.y * smoothstep(0.75, 0.95, vUp));
vec3 petals = vLook.x < 0.4 ? vec3(0.8, 0.8, 0.74) : (vLook.x < 0.75 ? vec3(0.8, 0.58, 0.05) : vec3(0.42, 0.22, 0.6));
diffuseColor.rgb = mix(diffuseColor.rgb, petals, vLook.w * uFlowers * smoothstep(0.86, 0.9, vUp));
diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, 0.55 * uSnow * vUp);
`;

/** Light through the blades, most at their tips. */
const LIGHT_GLSL = /* glsl */ `
#include <lights_fragment_end>
reflectedLight.directDiffuse += diffuseColor.rgb * RECIPROCAL_PI * directLight.color * vec3(1.1, 1.0, 0.5)
  * vUp * (0.12 + 0.6 * pow(saturate(dot(-geometryViewDir, directLight.direction)), 3.0));
`;

/** Share of the tufts that flower, in patches. */
const FLOWER_SHARE = 0.3;

/** The tuft of a cell: place and size, random number, dryness, width, flower. */
function tuftIn(column: number, row: number, spacing_m: number): number[] {
  const at = (channel: number) => hashUnit(73, column, row, channel);
  const x = (column + at(0)) * spacing_m;
  const z = (row + at(1)) * spacing_m;
  const open = glade(x, z);
  if (at(2) >= 0.34 + 0.6 * open) return [0, 0, 0, 0, 0, 0, 0, 0];
  // Patches of tall, of short and of dry grass.
  const tall = 0.5 + 0.5 * valueNoise(x / 7, z / 7, 811);
  const dry = 0.5 + 0.5 * valueNoise(x / 11, z / 11, 823);
  const size = (0.28 + 0.3 * at(3) + 0.5 * tall ** 2) * (0.45 + 0.55 * open);
  const flower = at(6) < FLOWER_SHARE * Math.max(0, 1 - 2 * Math.abs(dry - 0.4)) && open > 0.3 ? 1 : 0;
  const dryness = Math.min(1, at(5) ** 2 * (0.4 + 1.2 * dry));
  return [x, groundHeight_m(x, z) - 0.03, z, size, at(4), dryness, 1.35 - 0.5 * tall, flower];
}

export class GroundCover {
  readonly mesh: Mesh<InstancedBufferGeometry, MeshLambertMaterial>;
  private readonly uniforms = {
    uSeconds: { value: 0 },
    uEye: { value: new Vector3() },
    uReach: { value: 1 },
    uGrassTint: { value: new Color(1, 1, 1) },
    uFlowers: { value: 0 },
  };
  private field: PlantField | null = null;
  private quality: Quality | null = null;

  constructor(
    quality: Quality,
    private readonly wind: GroundWind,
  ) {
    this.mesh = new Mesh(new InstancedBufferGeometry(), this.material());
    this.mesh.frustumCulled = false;
    this.mesh.receiveShadow = true;
    this.mesh.renderOrder = 6;
    this.setQuality(quality);
  }

  private material(): MeshLambertMaterial {
    const material = new MeshLambertMaterial({ side: DoubleSide });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, air, seasonal, this.uniforms, this.wind.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", `#include <common>\n${VERTEX_PARS}`)
        // Use the normal of the ground.
        .replace("#include <beginnormal_vertex>", "vec3 objectNormal = vec3(0.0, 1.0, 0.0);")
        .replace("#include <begin_vertex>", POSITION_GLSL);
      const pars =
        "uniform vec3 uGrassTint;\nuniform float uFlowers;\nuniform float uSnow;\nuniform vec3 uSnowColour;\nvarying float vUp;\nvarying vec4 vLook;\n";
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${AIR_PARS}${pars}`)
        .replace("#include <map_fragment>", COLOUR_GLSL)
        .replace(
          "#include <normal_fragment_begin>",
          "vec3 normal = normalize(vNormal);\nvec3 nonPerturbedNormal = normal;",
        )
        .replace("#include <lights_fragment_end>", LIGHT_GLSL)
        .replace("#include <opaque_fragment>", AIR_FRAGMENT)
        .replace("#include <fog_fragment>", "");
    };
    material.customProgramCacheKey = () => "galewood-cover";
    return material;
  }

  setQuality(quality: Quality): void {
    if (quality === this.quality) return;
    this.quality = quality;
    const { side, spacing_m } = COVER_FIELDS[quality];
    this.field = new PlantField(tuft(), side, spacing_m, (out, at, column, row) =>
      out.set(tuftIn(column, row, spacing_m), at),
    );
    this.uniforms.uReach.value = this.field.reach_m;
    this.mesh.geometry.dispose();
    this.mesh.geometry = this.field.geometry;
  }

  setSeason(season: Season): void {
    this.mesh.visible = SEASON_LOOKS[season].snow === 0; // hidden under snow
    this.uniforms.uGrassTint.value.setRGB(...SEASON_LOOKS[season].grass);
    this.uniforms.uFlowers.value = season === "spring" || season === "summer" ? 1 : 0;
  }

  /** Follows the camera. */
  update(eye: Vector3, time_s: number): void {
    this.uniforms.uEye.value.copy(eye);
    this.uniforms.uSeconds.value = time_s % 1000;
    if (this.mesh.visible) this.field?.update(eye);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
