/** Leaves that the wind tears off the crowns around the camera: one draw call, animated in the vertex shader. */

import { hashUnit } from "galewood/random";
import {
  DoubleSide,
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  MeshLambertMaterial,
} from "three";
import type { Quality } from "../quality";
import { AIR_FRAGMENT, AIR_PARS, air } from "../sky/air";
import { CROWN_FLOATS, type Crowns } from "../sky/exposure";
import { flightFrom, LEAF_PATH, looseShare, REST_S } from "./leafFlight";
import { BLADE_GLSL, leafBlade } from "./looseLeaf";
import type { Season } from "./season";
import { seasonal } from "./seasonal";

const MAX_LEAVES: Record<Quality, number> = { low: 900, medium: 4600, high: 7600 };
/** Typical time from coming off to disappearing, s: a slot is free again after it. */
const LIFE_S = 8;
/** Leaves start on the surface of a crown, this share of its half axes from its centre. */
const SHELL_RADIUS_SHARE = 0.92;
const MOST_RANGES = 32;
/** Channels of the random numbers that choose the crowns of which the nearest lets a leaf go. */
const CROWN_CHANNELS = [0, 4, 5, 6, 7] as const;

const VERTEX_PARS = /* glsl */ `
attribute vec4 aFrom; // place where the leaf came off, m; time, s
attribute vec4 aFlight; // velocity, m/s; age at landing, s; height of the ground there, m
attribute vec4 aLook; // colour; random number
uniform float uClock;
varying vec3 vLeaf;
varying vec2 vBlade; // across and along the leaf
${LEAF_PATH}
mat3 tumbled(float seed, float age, float landed) {
  vec3 spin = vec3(4.0 + 5.0 * fract(seed * 17.0), 1.5 + 2.0 * fract(seed * 29.0), 3.0 + 4.0 * fract(seed * 41.0));
  vec3 angle = 6.2832 * fract(seed * vec3(3.0, 5.0, 7.0)) + spin * age;
  angle.xz *= 1.0 - landed; // comes to rest flat
  vec3 s = sin(angle);
  vec3 c = cos(angle);
  mat3 aboutX = mat3(1.0, 0.0, 0.0, 0.0, c.x, s.x, 0.0, -s.x, c.x);
  mat3 aboutY = mat3(c.y, 0.0, -s.y, 0.0, 1.0, 0.0, s.y, 0.0, c.y);
  mat3 aboutZ = mat3(c.z, s.z, 0.0, -s.z, c.z, 0.0, 0.0, 0.0, 1.0);
  return aboutY * aboutX * aboutZ;
}
`;

const NORMAL_GLSL = /* glsl */ `
float since = uClock - aFrom.w;
mat3 turned = tumbled(aLook.w, min(since, aFlight.z), smoothstep(aFlight.z - 0.5, aFlight.z, since));
vec3 objectNormal = turned * normal;
`;

const POSITION_GLSL = /* glsl */ `
vec3 path = leafAt(aFrom.xyz, aFlight, aLook.w, since);
// Drawn too large in the distance, where it would be less than a pixel wide.
float size = mix(0.05, 0.09, smoothstep(1.5, 8.0, distance(path, cameraPosition)))
  * (1.0 + 0.8 * fract(aLook.w * 53.0)) * step(0.0, since)
  * smoothstep(0.0, 0.15, since) * (1.0 - smoothstep(aFlight.z + ${(REST_S - 1).toFixed(1)}, aFlight.z + ${REST_S.toFixed(1)}, since));
vec3 transformed = path + turned * (size * position);
vLeaf = aLook.rgb;
vBlade = uv;
`;

/** Light through the leaf, whatever side the sun is on. */
const LIGHT_GLSL = /* glsl */ `
#include <lights_fragment_end>
reflectedLight.indirectDiffuse += diffuseColor.rgb * RECIPROCAL_PI * 0.2 * mix(uSunColour, directLight.color, 0.6);
`;

/** The crowns whose leaves fall. */
function sheddingOf(crowns: Crowns): Crowns {
  return crowns.filter((_, k) => crowns[k - (k % CROWN_FLOATS) + CROWN_FLOATS - 1] > 0);
}

export class FlyingLeaves {
  readonly mesh: Mesh<InstancedBufferGeometry, MeshLambertMaterial>;
  private readonly clock = { value: 0 };
  private most = 0;
  /** Leaves that came off so far, and the share of the next one. */
  private count = 0;
  private due = 0;
  private last_s = Number.NEGATIVE_INFINITY;
  private given: Crowns | null = null;
  private shedding: Crowns = new Float32Array(0);

  constructor(
    quality: Quality,
    private readonly groundHeight_m: (x: number, z: number) => number,
  ) {
    this.mesh = new Mesh(new InstancedBufferGeometry(), this.material());
    this.mesh.frustumCulled = false;
    this.mesh.receiveShadow = true;
    this.mesh.visible = false;
    this.mesh.renderOrder = 7;
    this.setQuality(quality);
  }

  private material(): MeshLambertMaterial {
    const material = new MeshLambertMaterial({ side: DoubleSide });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, air, seasonal, { uClock: this.clock });
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", `#include <common>\n${VERTEX_PARS}`)
        .replace("#include <beginnormal_vertex>", NORMAL_GLSL)
        .replace("#include <begin_vertex>", POSITION_GLSL);
      const pars = "uniform vec3 uSunColour;\nvarying vec3 vLeaf;\nvarying vec2 vBlade;\n";
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${AIR_PARS}${pars}${BLADE_GLSL}`)
        .replace("#include <map_fragment>", "diffuseColor.rgb = blade(vLeaf, vBlade);")
        .replace("#include <lights_fragment_end>", LIGHT_GLSL)
        .replace("#include <opaque_fragment>", AIR_FRAGMENT)
        .replace("#include <fog_fragment>", "");
    };
    material.customProgramCacheKey = () => "galewood-flying";
    return material;
  }

  setQuality(quality: Quality): void {
    const most = MAX_LEAVES[quality];
    if (most === this.most) return;
    this.most = most;
    const leaf = leafBlade();
    const geometry = new InstancedBufferGeometry();
    geometry.setIndex(leaf.index);
    geometry.setAttribute("position", leaf.getAttribute("position"));
    geometry.setAttribute("normal", leaf.getAttribute("normal"));
    for (const name of ["aFrom", "aFlight", "aLook"]) {
      const attribute = new InstancedBufferAttribute(new Float32Array(4 * most), 4);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    // Not yet born, and never at rest.
    (geometry.getAttribute("aFrom").array as Float32Array).fill(1e9);
    (geometry.getAttribute("aFlight").array as Float32Array).fill(1);
    geometry.instanceCount = most;
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.count = 0;
  }

  /** Lets leaves fly for dt_s from those of these crowns that are not evergreen. */
  advance(
    dt_s: number,
    wind_m_s: { x: number; z: number },
    season: Season,
    crowns: Crowns,
    eye: { x: number; z: number },
  ): void {
    this.clock.value += dt_s;
    const rate = (this.most / LIFE_S) * looseShare(Math.hypot(wind_m_s.x, wind_m_s.z), season);
    if (crowns !== this.given) [this.given, this.shedding] = [crowns, sheddingOf(crowns)];
    const { shedding } = this;
    this.due = shedding.length > 0 ? this.due + rate * dt_s : 0;
    const fresh = Math.min(this.most, Math.floor(this.due));
    this.due -= Math.floor(this.due);
    for (let k = 0; k < fresh; k++) this.release(wind_m_s, shedding, eye, dt_s * ((k + 0.5) / fresh));
    if (fresh > 0) this.upload(fresh);
    this.mesh.visible = season !== "winter" && this.clock.value < this.last_s;
  }

  /** Releases one leaf, `ago_s` before now. */
  private release(
    wind_m_s: { x: number; z: number },
    crowns: Crowns,
    eye: { x: number; z: number },
    ago_s: number,
  ): void {
    const at = (channel: number) => hashUnit(89, this.count, channel);
    const crown = this.nearer(crowns, eye, at);
    const [x, y, z, wide, tall, r, g, b] = crowns.subarray(crown, crown + CROWN_FLOATS);
    const azimuth = 2 * Math.PI * at(1);
    const sine = 2 * at(2) - 1;
    const level = SHELL_RADIUS_SHARE * wide * Math.sqrt(1 - sine * sine);
    const from = {
      x: x + level * Math.cos(azimuth),
      y: y + SHELL_RADIUS_SHARE * tall * sine,
      z: z + level * Math.sin(azimuth),
    };
    const { vx, vz, lands_s, ground_m, seed } = flightFrom(from, wind_m_s, this.count, this.groundHeight_m);
    const slot = this.count % this.most;
    const born_s = this.clock.value - ago_s;
    this.attribute("aFrom").setXYZW(slot, from.x, from.y, from.z, born_s);
    this.attribute("aFlight").setXYZW(slot, vx, vz, lands_s, ground_m);
    const light = 0.75 + 0.5 * at(3);
    this.attribute("aLook").setXYZW(slot, light * r, light * g, light * b, seed);
    this.last_s = Math.max(this.last_s, born_s + lands_s + REST_S);
    this.count++;
  }

  /** The nearest to the eye of some random crowns: near leaves are seen best. */
  private nearer(crowns: Crowns, eye: { x: number; z: number }, at: (channel: number) => number): number {
    let [best, least_m] = [0, Number.POSITIVE_INFINITY];
    for (const channel of CROWN_CHANNELS) {
      const crown = CROWN_FLOATS * Math.floor((at(channel) * crowns.length) / CROWN_FLOATS);
      const away_m = Math.hypot(crowns[crown] - eye.x, crowns[crown + 2] - eye.z);
      if (away_m < least_m) [best, least_m] = [crown, away_m];
    }
    return best;
  }

  private attribute(name: string): InstancedBufferAttribute {
    return this.mesh.geometry.getAttribute(name) as InstancedBufferAttribute;
  }

  /** Uploads the slots of the newest leaves only. */
  private upload(fresh: number): void {
    const first = (this.count - fresh) % this.most;
    for (const name of ["aFrom", "aFlight", "aLook"]) {
      const attribute = this.attribute(name);
      // Ranges pile up while nothing is drawn: upload everything then.
      if (attribute.updateRanges.length > MOST_RANGES) {
        attribute.clearUpdateRanges();
        attribute.addUpdateRange(0, 4 * this.most);
      }
      attribute.addUpdateRange(4 * first, 4 * Math.min(fresh, this.most - first));
      if (first + fresh > this.most) attribute.addUpdateRange(0, 4 * (first + fresh - this.most));
      attribute.needsUpdate = true;
    }
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
