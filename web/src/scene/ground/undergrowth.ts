/** Shrubs, ferns and fallen leaves around the camera: one draw call each. They bend with the wind. */
import {
  type BufferGeometry,
  type DataTexture,
  DoubleSide,
  Group,
  Mesh,
  MeshLambertMaterial,
  Vector3,
} from "three";
import type { Quality } from "../quality";
import { undergrowthTint } from "../season/palette";
import { SEASON_LOOKS, type Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { AIR_FRAGMENT, AIR_PARS, air } from "../sky/air";
import type { Crowns } from "../sky/exposure";
import { GROUND_WIND_PARS, type GroundWind } from "./groundWind";
import { groundHeight_m } from "./landscape";
import { PlantField } from "./plantField";
import { fern, leafBlade, shrub } from "./plantShapes";
import { Trunks } from "./trunks";
import { fernAt, leafAt, type Plant, shrubAt } from "./undergrowthPlaces";

type Kind = "shrub" | "fern" | "leaf";
const KINDS = ["shrub", "fern", "leaf"] as const;
/** Cells along each axis, and their size; 0 cells: left out. */
const FIELDS: Record<Quality, Record<Kind, readonly [side: number, spacing_m: number]>> = {
  low: { shrub: [18, 2.6], fern: [0, 1], leaf: [0, 1] },
  medium: { shrub: [26, 2.2], fern: [40, 1.15], leaf: [70, 0.36] },
  high: { shrub: [40, 2.2], fern: [64, 1.15], leaf: [120, 0.33] },
};
const SHAPES: Record<Kind, () => BufferGeometry> = { shrub, fern, leaf: leafBlade };
/** How far each kind bends at its top, relative to its height and to the lean of grass, rad. */
const BEND_SHARES: Record<Kind, number> = { shrub: 0.16, fern: 0.3, leaf: 0 };

const VERTEX_PARS = /* glsl */ `
attribute vec4 aPlant; // x, y, z, size in m
attribute vec4 aLook; // colour; random number
uniform float uSeconds;
uniform vec3 uEye;
uniform float uReach;
varying vec2 vPlant;
varying vec4 vLook;
varying float vUp;
${GROUND_WIND_PARS}`;

const NORMAL_GLSL = /* glsl */ `
float turn = aLook.w * 6.2832;
mat2 spin = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
vec3 objectNormal = vec3(spin * normal.xz, normal.y).xzy;
`;

const POSITION_GLSL = /* glsl */ `
float near = 1.0 - smoothstep(0.75, 1.0, distance(aPlant.xz, uEye.xz) / uReach);
vec2 spun = spin * position.xz;
float beat = uSeconds * 5.0 + aLook.w * 30.0;
float tremble = 1.0 + 0.12 * sin(beat) + 0.08 * sin(2.7 * beat + 9.0 * position.x);
vec2 bow = leanAt(aPlant.xz) * BEND * tremble * position.y * position.y;
#ifdef FLAT
  // A fallen leaf lies askew.
  vec3 transformed = aPlant.xyz + aPlant.w * near * vec3(spun.x, position.y + 0.5 * (fract(aLook.w * 7.0) - 0.4) * position.x, spun.y);
#else
  vec3 transformed = aPlant.xyz + aPlant.w * near * vec3(spun.x + bow.x, position.y - dot(bow, bow), spun.y + bow.y);
#endif
vPlant = uv;
vLook = aLook;
vUp = position.y;
`;

const COLOUR_GLSL = /* glsl */ `
#ifdef FLAT
  diffuseColor.rgb = vLook.rgb;
#else
  vec4 plant = texture2D(uPlants, vPlant);
  vec2 size = vec2(textureSize(uPlants, 0));
  float texels = max(length(dFdx(vPlant) * size), length(dFdy(vPlant) * size));
  // Mip levels reduce the coverage: restore it.
  if (plant.a * (1.0 + 0.05 * max(0.0, log2(texels))) < 0.42) discard;
  vec3 own = plant.rgb / max(plant.a, 0.15);
  if (uBare > 0.5 && own.g < 0.5) discard; // the leaves have fallen
  vec3 leaf = vLook.rgb * (0.12 + 1.4 * own.r) * mix(vec3(1.15, 1.0, 0.75), vec3(0.9, 1.02, 1.1), own.b);
  diffuseColor.rgb = mix(leaf, vec3(0.12, 0.085, 0.06), own.g);
  // Deep inside the plant it is darker.
  diffuseColor.rgb *= 0.5 + 0.5 * smoothstep(0.0, 0.6, vUp);
  diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, uSnow * smoothstep(0.35, 0.7, own.r + 0.2 * vUp));
#endif
`;

const LIGHT_GLSL = /* glsl */ `
#include <lights_fragment_end>
reflectedLight.indirectDiffuse += diffuseColor.rgb * RECIPROCAL_PI * (0.06 * uSunColour + 0.14 * directLight.color)
  * vec3(1.05, 1.0, 0.6);
`;

interface Layer {
  readonly kind: Kind;
  readonly field: PlantField;
  readonly mesh: Mesh<PlantField["geometry"], MeshLambertMaterial>;
  readonly reach: { value: number };
}

export class Undergrowth {
  readonly group = new Group();
  private layers: Layer[] = [];
  private trunks = new Trunks(new Float32Array(0));
  private season: Season = "autumn";
  private quality: Quality | null = null;
  private readonly shared = {
    uSeconds: { value: 0 },
    uEye: { value: new Vector3() },
    uBare: { value: 0 },
  };

  constructor(
    quality: Quality,
    private readonly plants: DataTexture,
    private readonly wind: GroundWind,
  ) {
    this.setQuality(quality);
  }

  setQuality(quality: Quality): void {
    if (quality === this.quality) return;
    this.quality = quality;
    this.clear();
    this.layers = KINDS.flatMap((kind) => this.layer(kind, ...FIELDS[quality][kind]));
    this.group.add(...this.layers.map(({ mesh }) => mesh));
    this.dress();
  }

  private layer(kind: Kind, side: number, spacing_m: number): Layer[] {
    if (side === 0) return [];
    const field = new PlantField(SHAPES[kind](), side, spacing_m, (out, at, column, row) =>
      this.write(kind, spacing_m, out, at, column, row),
    );
    const reach = { value: field.reach_m };
    const mesh = new Mesh(field.geometry, this.material(kind, reach));
    mesh.frustumCulled = false;
    mesh.receiveShadow = true;
    mesh.renderOrder = 6;
    return [{ kind, field, mesh, reach }];
  }

  private write(
    kind: Kind,
    spacing_m: number,
    out: Float32Array,
    at: number,
    column: number,
    row: number,
  ): void {
    const { plant, colour } = this.plantIn(kind, spacing_m, column, row);
    const sunk_m = kind === "leaf" ? -0.02 : 0.05;
    const y = plant.size_m > 0 ? groundHeight_m(plant.x, plant.z) - sunk_m : 0;
    out.set([plant.x, y, plant.z, plant.size_m, ...colour, plant.turn], at);
  }

  private plantIn(kind: Kind, spacing_m: number, column: number, row: number) {
    const { trunks, season } = this;
    if (kind === "leaf") {
      const leaf = leafAt(column, row, spacing_m, trunks, SEASON_LOOKS[season].fallen);
      const crown = leaf.size_m > 0 ? trunks.crownOf(leaf.crown).colour : null;
      return { plant: leaf, colour: undergrowthTint(kind, leaf.hue, season, crown) };
    }
    const plant: Plant = (kind === "shrub" ? shrubAt : fernAt)(column, row, spacing_m, trunks);
    return { plant, colour: undergrowthTint(kind, plant.hue, season, null) };
  }

  private material(kind: Kind, reach: { value: number }): MeshLambertMaterial {
    const material = new MeshLambertMaterial({ side: DoubleSide });
    const defines = `#define BEND ${BEND_SHARES[kind].toFixed(2)}\n${kind === "leaf" ? "#define FLAT\n" : ""}`;
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, air, seasonal, this.shared, this.wind.uniforms, {
        uReach: reach,
        uPlants: { value: this.plants },
      });
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", `#include <common>\n${defines}${VERTEX_PARS}`)
        .replace("#include <beginnormal_vertex>", NORMAL_GLSL)
        .replace("#include <begin_vertex>", POSITION_GLSL);
      const pars =
        "uniform sampler2D uPlants;\nuniform float uBare;\nuniform float uSnow;\nuniform vec3 uSnowColour;\n" +
        "uniform vec3 uSunColour;\nvarying vec2 vPlant;\nvarying vec4 vLook;\nvarying float vUp;\n";
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${defines}${AIR_PARS}${pars}`)
        .replace("#include <map_fragment>", COLOUR_GLSL)
        // The same normal on both sides of a card.
        .replace(
          "#include <normal_fragment_begin>",
          "vec3 normal = normalize(vNormal);\nvec3 nonPerturbedNormal = normal;",
        )
        .replace("#include <lights_fragment_end>", LIGHT_GLSL)
        .replace("#include <opaque_fragment>", AIR_FRAGMENT)
        .replace("#include <fog_fragment>", "");
    };
    material.customProgramCacheKey = () => `galewood-undergrowth-${kind}`;
    return material;
  }

  /** Keeps clear of these trees, and covers the ground below them with their leaves. */
  shelter(crowns: Crowns): void {
    this.trunks = new Trunks(crowns);
    for (const { field } of this.layers) field.reset();
  }

  setSeason(season: Season): void {
    if (season === this.season) return;
    this.season = season;
    this.dress();
  }

  /** Shows the layers of the season and grows them in its colours. */
  private dress(): void {
    const { season } = this;
    const snowy = SEASON_LOOKS[season].snow > 0;
    this.shared.uBare.value = season === "winter" ? 1 : 0;
    for (const { kind, field, mesh } of this.layers) {
      mesh.visible = kind === "shrub" || !snowy; // the rest lies under the snow
      field.reset();
    }
  }

  /** Follows the camera. */
  update(eye: Vector3, time_s: number): void {
    this.shared.uEye.value.copy(eye);
    this.shared.uSeconds.value = time_s % 1000;
    for (const { field, mesh } of this.layers) if (mesh.visible) field.update(eye);
  }

  private clear(): void {
    for (const { mesh } of this.layers) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    this.layers = [];
  }

  dispose(): void {
    this.clear();
  }
}
