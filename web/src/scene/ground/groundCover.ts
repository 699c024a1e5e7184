/**
 * Grass tufts around the camera, on a lattice that wraps around it, so that tufts stay in place while the camera moves.
 * They bend with the wind.
 */
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  MeshLambertMaterial,
  Vector2,
  Vector3,
} from "three";
import { hashUnit } from "../../core/math/random";
import type { Quality } from "../quality";
import { SEASON_LOOKS, type Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { AIR_FRAGMENT, AIR_PARS, air } from "../sky/air";
import { glade, groundHeight_m } from "./landscape";

const COVER: Record<Quality, { side: number; spacing_m: number }> = {
  low: { side: 56, spacing_m: 0.85 },
  medium: { side: 96, spacing_m: 0.62 },
  high: { side: 176, spacing_m: 0.46 },
};
const BLADES = 7;
const HEIGHT_M = 0.42;

/** A tuft of bent blades around the origin, each of three triangles and with a pointed tip; y runs from 0 to 1. */
function tuft(): BufferGeometry {
  const position: number[] = [];
  const index: number[] = [];
  for (let blade = 0; blade < BLADES; blade++) {
    const at = (channel: number) => hashUnit(61, blade, channel);
    const angle = (blade / BLADES + 0.1 * at(0)) * 2 * Math.PI;
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
attribute vec4 aTuft; // x, y, z in m; size, 0 for none
attribute vec2 aLook; // random number, dryness
uniform vec3 uBreeze; // heading and speed of the wind, m/s; seconds
uniform vec3 uEye;
uniform float uReach;
varying float vUp;
varying vec2 vLook;
`;

const POSITION = /* glsl */ `
float near = 1.0 - smoothstep(0.7, 1.0, distance(aTuft.xz, uEye.xz) / uReach);
float turn = aLook.x * 6.2832;
vec2 spun = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * position.xz;
float speed = length(uBreeze.xy);
float gust = 0.6 + 0.4 * sin(uBreeze.z * 2.1 - dot(aTuft.xz, uBreeze.xy) * 0.16 / max(speed, 0.5) * 4.0 + aLook.x * 2.0);
vec2 bow = uBreeze.xy * min(0.05, 0.6 / max(speed, 1.0)) * gust * position.y * position.y;
float size = aTuft.w * near;
vec3 transformed = aTuft.xyz + size * vec3(spun.x + bow.x, position.y * ${HEIGHT_M.toFixed(2)} / 0.42 - 0.4 * dot(bow, bow), spun.y + bow.y);
vUp = position.y;
vLook = aLook;
`;

const COLOUR = /* glsl */ `
vec3 green = mix(vec3(0.12, 0.17, 0.035), vec3(0.34, 0.3, 0.1), vLook.y) * uGrassTint;
diffuseColor.rgb = green * (0.35 + 0.85 * vUp) * (0.8 + 0.4 * vLook.x);
diffuseColor.rgb = mix(diffuseColor.rgb, uSnowColour, 0.55 * uSnow * vUp);
`;

export class GroundCover {
  readonly mesh: Mesh<InstancedBufferGeometry, MeshLambertMaterial>;
  private readonly uniforms = {
    uBreeze: { value: new Vector3() },
    uEye: { value: new Vector3() },
    uReach: { value: 1 },
    uGrassTint: { value: new Color(1, 1, 1) },
  };
  private side = 0;
  private spacing_m = 1;
  private column = Number.NaN;
  private row = Number.NaN;

  constructor(quality: Quality) {
    this.mesh = new Mesh(new InstancedBufferGeometry(), this.material());
    this.mesh.frustumCulled = false;
    this.mesh.receiveShadow = true;
    this.mesh.renderOrder = 6;
    this.setQuality(quality);
  }

  private material(): MeshLambertMaterial {
    const material = new MeshLambertMaterial({ side: DoubleSide });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, air, seasonal, this.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", `#include <common>\n${VERTEX_PARS}`)
        // Use the normal of the ground.
        .replace("#include <beginnormal_vertex>", "vec3 objectNormal = vec3(0.0, 1.0, 0.0);")
        .replace("#include <begin_vertex>", POSITION);
      const pars =
        "uniform vec3 uGrassTint;\nuniform float uSnow;\nuniform vec3 uSnowColour;\nvarying float vUp;\nvarying vec2 vLook;\n";
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${AIR_PARS}${pars}`)
        .replace("#include <map_fragment>", COLOUR)
        .replace(
          "#include <normal_fragment_begin>",
          "vec3 normal = normalize(vNormal);\nvec3 nonPerturbedNormal = normal;",
        )
        .replace("#include <opaque_fragment>", AIR_FRAGMENT)
        .replace("#include <fog_fragment>", "");
    };
    material.customProgramCacheKey = () => "galewood-cover";
    return material;
  }

  setQuality(quality: Quality): void {
    const { side, spacing_m } = COVER[quality];
    if (side === this.side) return;
    this.side = side;
    this.spacing_m = spacing_m;
    this.uniforms.uReach.value = 0.5 * side * spacing_m;
    const geometry = new InstancedBufferGeometry();
    const blades = tuft();
    geometry.setIndex(blades.index);
    geometry.setAttribute("position", blades.getAttribute("position"));
    geometry.setAttribute("normal", blades.getAttribute("normal"));
    geometry.setAttribute("aTuft", new InstancedBufferAttribute(new Float32Array(side * side * 4), 4));
    geometry.setAttribute("aLook", new InstancedBufferAttribute(new Float32Array(side * side * 2), 2));
    geometry.instanceCount = side * side;
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.column = Number.NaN;
  }

  setSeason(season: Season): void {
    this.mesh.visible = SEASON_LOOKS[season].snow === 0; // hidden under snow
    this.uniforms.uGrassTint.value.setRGB(...SEASON_LOOKS[season].grass);
  }

  /** Follows the camera and applies the wind of this step. */
  update(eye: Vector3, wind_m_s: { x: number; z: number }, time_s: number): void {
    this.uniforms.uEye.value.copy(eye);
    this.uniforms.uBreeze.value.set(wind_m_s.x, wind_m_s.z, time_s);
    this.populate(Math.round(eye.x / this.spacing_m), Math.round(eye.z / this.spacing_m));
  }

  /** Fills the cells that came into range; all others keep their tufts. */
  private populate(column: number, row: number): void {
    if (column === this.column && row === this.row) return;
    const { side } = this;
    const fresh = Number.isNaN(this.column);
    const half = side >> 1;
    for (let r = row - half; r < row + half; r++) {
      const known = !fresh && r >= this.row - half && r < this.row + half;
      for (let c = column - half; c < column + half; c++) {
        if (known && c >= this.column - half && c < this.column + half) continue;
        this.grow(c, r);
      }
    }
    this.column = column;
    this.row = row;
    this.mesh.geometry.getAttribute("aTuft").needsUpdate = true;
    this.mesh.geometry.getAttribute("aLook").needsUpdate = true;
  }

  private grow(column: number, row: number): void {
    const { side, spacing_m } = this;
    const slot = (((row % side) + side) % side) * side + (((column % side) + side) % side);
    const at = (channel: number) => hashUnit(73, column, row, channel);
    const x = (column + at(0)) * spacing_m;
    const z = (row + at(1)) * spacing_m;
    const open = glade(x, z);
    const grows = at(2) < 0.16 + 0.7 * open;
    const size = grows ? (0.35 + 0.5 * at(3)) * (0.55 + 0.45 * open) : 0;
    const y = size > 0 ? groundHeight_m(x, z) - 0.03 : 0;
    (this.mesh.geometry.getAttribute("aTuft") as BufferAttribute).setXYZW(slot, x, y, z, size);
    (this.mesh.geometry.getAttribute("aLook") as BufferAttribute).setXY(slot, at(4), at(5) ** 2);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
