/**
 * The canopy seen from afar: one bumpy surface at the height of the crowns. It fills the gaps between the trees of the thinned
 * background, and covers the land beyond the last of them up to the horizon.
 */
import { hashUnit } from "galewood/random";
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Mesh,
  MeshLambertMaterial,
  type Texture,
} from "three";
import { glade, groundHeight_m } from "../ground/landscape";
import { LAND_REACH_M, ringIndex } from "../ground/terrain";
import { FOREST_CENTRE } from "../placement";
import type { Quality } from "../quality";
import { SEASON_LOOKS, type Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { AIR_FRAGMENT, AIR_PARS, air } from "../sky/air";
import { smoothstep } from "../sky/weather";
import { REACH_M, THINNING_LEVELS } from "./farPlaces";

const SECTOR_COUNT = 256;
const RING_COUNT = 72;
/** Rings are denser near the forest by this power. */
const RING_POWER = 2.2;
/** The surface rises to the low crowns between the background trees, and beyond these to the tops, within these distances, m. */
const RISE_M = { low: 35, high: 45 } as const;
/** Height of the surface between the background trees and beyond them, relative to the height of the trees. */
const HEIGHT_SHARES = { between: 0.34, beyond: 0.86 } as const;
/** Vertices differ in height by up to this share. */
const ROUGH_SHARE = 0.22;
/** Least distance from the simulated trees, m. */
const CLEAR_M = 12;
const HASH_SEED = 379;

/** Distance from the centre of the forest at which the surface begins, m. */
export function canopyFrom_m(edge_m: number, background: boolean): number {
  return Math.max(edge_m + CLEAR_M, background ? 0 : REACH_M);
}

/** Height of the surface above the ground, m, at a distance from the centre of the forest; `crown_m`: height of the trees. */
export function canopyHeight_m(distance_m: number, from_m: number, crown_m: number): number {
  const { between, beyond } = HEIGHT_SHARES;
  const last_m = Math.max(REACH_M, from_m);
  const low = between * smoothstep(from_m, from_m + RISE_M.low, distance_m);
  return (
    crown_m *
    (low + (beyond - between) * smoothstep(last_m - RISE_M.high, last_m, distance_m) * (low / between))
  );
}

const VERTEX_PARS = /* glsl */ `
attribute float aTall;
uniform float uFull; // up to this distance (m) from the eye all trees are drawn
varying vec3 vPlace;
varying float vTall;
`;

/** Where all trees are drawn, the surface sinks into the ground. */
const POSITION_GLSL = /* glsl */ `
#include <begin_vertex>
float risen = smoothstep(0.7, 1.3, distance(position.xz, cameraPosition.xz) / uFull);
vTall = aTall * risen;
transformed.y -= aTall - vTall;
vPlace = transformed;
`;

/** Crowns as cells of a jittered lattice: each has its own colour and a rounded top. */
const COLOUR_PARS = /* glsl */ `
varying vec3 vPlace;
varying float vTall;
uniform sampler2D uNoise;
uniform vec3 uWoods[3];
uniform float uSnow;
uniform vec3 uSnowColour;
uniform float uFull;
const float CROWN_M = 5.6;
vec3 random3(vec2 cell) {
  vec3 p = fract(vec3(cell.xyx) * vec3(0.1031, 0.1030, 0.0973));
  p += dot(p, p.yxz + 33.33);
  return fract((p.xxy + p.yzz) * p.zyx);
}
`;

const COLOUR_GLSL = /* glsl */ `
// Boughs: crowns have no sharp outlines, also where the surface is steep.
vec3 boughs = texture2D(uNoise, vPlace.xz * 0.021 + vTall * 0.017).rgb - 0.5;
vec3 twigs = texture2D(uNoise, vPlace.xz * 0.083 + vTall * 0.061).rgb - 0.5;
vec3 leaves = texture2D(uNoise, vPlace.xz * 0.29 + vTall * 0.19).rgb - 0.5;
vec2 at = vPlace.xz / CROWN_M + 0.07 * vTall + 0.5 * boughs.xy + 0.5 * twigs.xy + 0.12 * leaves.xy;
vec2 cell = floor(at);
float nearest = 9.0;
vec2 out_ = vec2(0.0);
vec3 own = vec3(0.5);
for (int k = 0; k < 9; k++) {
  vec2 other = cell + vec2(float(k % 3) - 1.0, float(k / 3) - 1.0);
  vec3 chance = random3(other);
  vec2 away = at - other - 0.15 - 0.7 * chance.xy;
  float d = dot(away, away) / (0.7 + 0.6 * chance.z);
  if (d < nearest) {
    nearest = d;
    out_ = away;
    own = chance;
  }
}
// Where a crown is smaller than a pixel, its mean is drawn.
float fine = 1.0 - smoothstep(0.25, 0.9, max(fwidth(at.x), fwidth(at.y)));
if (vTall < 0.5) discard; // sunk
float dome = sqrt(max(0.0, 1.0 - 2.1 * nearest));
// Clumps of leaves, and dark gaps between them.
float light = smoothstep(-0.3, 0.25, twigs.z + 0.8 * leaves.z) * (0.9 + 0.8 * leaves.x + 0.6 * boughs.z) * 1.2;
vec3 woods = mix(uWoods[0], mix(uWoods[1], uWoods[2], step(0.5, own.y)), 0.8 * smoothstep(0.35, 0.65, own.z));
vec3 mean = (2.0 * uWoods[0] + uWoods[1] + uWoods[2]) * 0.25;
// Nearer, where trees stand before it, it is the low wood between them, without crowns of its own.
float crowns = smoothstep(1.2 * uFull, 2.2 * uFull, length(vViewPosition));
vec3 low = mean * vec3(0.5, 0.6, 0.5) * (0.6 + 0.8 * own.x) * (0.25 + 0.75 * light);
vec3 tops = woods * (0.85 + 0.3 * own.x) * (0.2 + 0.8 * dome) * (0.4 + 0.6 * light);
diffuseColor.rgb = mix(mean * 0.7, mix(low, tops, crowns), fine);
diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, 0.4 * uSnow * mix(0.7, smoothstep(0.3, 1.0, dome), fine));
// Below the tops it gets dark.
float sunk = gl_FrontFacing ? smoothstep(0.6, 9.0, vTall) : 0.25;
diffuseColor.rgb *= 0.3 + 0.7 * sunk;
`;

const NORMAL_GLSL = /* glsl */ `
vec3 upright = normalize(vec3(fine * (1.7 * out_.x + 1.6 * twigs.x + 1.2 * leaves.x), 0.35 + 0.8 * dome, fine * (1.7 * out_.y + 1.6 * twigs.y + 1.2 * leaves.y)));
vec3 normal = normalize(mix(normalize(vNormal), (viewMatrix * vec4(upright, 0.0)).xyz, 0.8));
vec3 nonPerturbedNormal = normal;
`;

/** Light from behind shines through the leaves. */
const LIGHT_GLSL = /* glsl */ `
#include <lights_fragment_end>
reflectedLight.directDiffuse += diffuseColor.rgb * RECIPROCAL_PI * directLight.color * vec3(0.5, 0.45, 0.2);
`;

export class Canopy {
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  private readonly uniforms = {
    uWoods: { value: [new Color(), new Color(), new Color()] },
    uFull: { value: 0 },
  };
  private key = "";

  constructor(private readonly noise: Texture) {
    this.mesh = new Mesh(new BufferGeometry(), this.material());
    this.mesh.visible = false;
    this.mesh.renderOrder = 5;
    this.mesh.matrixAutoUpdate = false;
  }

  private material(): MeshLambertMaterial {
    const material = new MeshLambertMaterial({ side: DoubleSide });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, air, seasonal, this.uniforms, { uNoise: { value: this.noise } });
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", `#include <common>\n${VERTEX_PARS}`)
        .replace("#include <begin_vertex>", POSITION_GLSL);
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${AIR_PARS}${COLOUR_PARS}`)
        .replace("#include <map_fragment>", COLOUR_GLSL)
        .replace("#include <normal_fragment_begin>", NORMAL_GLSL)
        .replace("#include <lights_fragment_end>", LIGHT_GLSL)
        .replace("#include <opaque_fragment>", AIR_FRAGMENT)
        .replace("#include <fog_fragment>", "");
    };
    material.customProgramCacheKey = () => "galewood-canopy";
    return material;
  }

  setSeason(season: Season): void {
    SEASON_LOOKS[season].woods.forEach((colour, k) => {
      this.uniforms.uWoods.value[k].setRGB(...colour);
    });
  }

  /** Dissolves the surface up to the distance from the eye at which the trees above it are thinned. */
  setQuality(quality: Quality): void {
    this.uniforms.uFull.value = THINNING_LEVELS[quality].full_m;
  }

  /** Lays the surface around a forest: from this distance from its centre on, over trees of this height. */
  spread(from_m: number, crown_m: number): void {
    const key = `${from_m.toFixed(0)} ${crown_m.toFixed(1)}`;
    if (key === this.key) return;
    this.key = key;
    this.mesh.geometry.dispose();
    this.mesh.geometry = surface(from_m, crown_m);
    this.mesh.visible = from_m < LAND_REACH_M;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

function surface(from_m: number, crown_m: number): BufferGeometry {
  const columns = SECTOR_COUNT + 1;
  const position = new Float32Array(3 * (RING_COUNT + 1) * columns);
  const tall = new Float32Array((RING_COUNT + 1) * columns);
  const last_m = LAND_REACH_M - Math.hypot(FOREST_CENTRE.x_m, FOREST_CENTRE.z_m);
  for (let ring = 0; ring <= RING_COUNT; ring++) {
    const distance_m = from_m + Math.max(0, last_m - from_m) * (ring / RING_COUNT) ** RING_POWER;
    const full_m = canopyHeight_m(distance_m, from_m, crown_m);
    for (let sector = 0; sector < columns; sector++) {
      const angle = (2 * Math.PI * (sector + 0.5 * (ring & 1))) / SECTOR_COUNT;
      const x = FOREST_CENTRE.x_m + distance_m * Math.cos(angle);
      const z = FOREST_CENTRE.z_m + distance_m * Math.sin(angle);
      const rough = 1 - ROUGH_SHARE * hashUnit(HASH_SEED, ring, sector % SECTOR_COUNT);
      const v = ring * columns + sector;
      tall[v] = full_m * rough * (1 - glade(x, z));
      position.set([x, groundHeight_m(x, z) + tall[v], z], 3 * v);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("aTall", new BufferAttribute(tall, 1));
  geometry.setIndex(new BufferAttribute(ringIndex(RING_COUNT, SECTOR_COUNT), 1));
  geometry.computeVertexNormals();
  return geometry;
}
