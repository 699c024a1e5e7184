/** The dark foot of every stem near the camera: what light the stem keeps from the ground around it. One draw call. */
import {
  DoubleSide,
  DynamicDrawUsage,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  Mesh,
  MultiplyBlending,
  PlaneGeometry,
  ShaderMaterial,
  type Vector3,
} from "three";
import { seasonal } from "../season/seasonal";
import { air } from "../sky/air";
import { CROWN_FLOATS, type Crowns } from "../sky/exposure";
import { groundHeight_m, slopeAt } from "./landscape";

/** Feet are drawn up to this distance, m, and chosen again when the camera has moved by a tenth of it. */
const REACH_M = 48;
const MOVED_M = 0.1 * REACH_M;
const MOST_FEET = 512;
/** Per foot: x, y, z, half width (m); slope of the ground along x and z. */
const FOOT_FLOATS = 6;
/** Half width over the half height of the crown, and the least, m. */
const WIDTH_SHARE = 0.16;
const LEAST_WIDTH_M = 0.7;
/** Distance over which the slope of the ground is measured, m. */
const SLOPE_M = 0.6;

/** How much wider the rim of snow around a stem is than its dark foot. */
const RIM_WIDTH = 1.7;

const FOOT_VERTEX = /* glsl */ `
uniform float uSnow;
attribute vec4 aFoot;
attribute vec2 aSlope;
varying vec2 vOut;
varying float vAway;
void main() {
  float wider = mix(1.0, ${RIM_WIDTH.toFixed(1)}, uSnow);
  vOut = wider * position.xy;
  vec2 off = aFoot.w * vOut;
  vec4 seen = viewMatrix * vec4(aFoot.xyz + vec3(off.x, dot(aSlope, off) + 0.02, off.y), 1.0);
  vAway = length(seen.xyz);
  gl_Position = projectionMatrix * seen;
}
`;

const FOOT_FRAGMENT = /* glsl */ `
uniform float uSnow;
uniform vec2 uSunFlat;
uniform vec3 uSunWorld;
varying vec2 vOut;
varying float vAway;
/** Light that the snow keeps around a stem: it lies hollow at the bark and in a rim around it, whose side away from the sun is blue. */
vec3 rimLight(vec2 away) {
  float far = length(away);
  // Slope of the rim outwards: up from the stem, then down to level ground.
  float rise = 0.5 * (smoothstep(0.12, 0.35, far) - smoothstep(0.35, 0.75, far))
    - 0.34 * (smoothstep(0.6, 0.95, far) - smoothstep(1.2, ${RIM_WIDTH.toFixed(1)}, far));
  float low = clamp(uSunWorld.y, 0.15, 1.0);
  float lost = rise * dot(away / max(far, 0.01), uSunFlat) * sqrt(1.0 - low * low) / low;
  return 1.0 - clamp(lost, 0.0, 0.75) * vec3(0.62, 0.5, 0.3);
}
void main() {
  float dark = pow(max(0.0, 1.0 - length(vOut)), 1.6);
  float near = 1.0 - smoothstep(${(0.7 * REACH_M).toFixed(1)}, ${REACH_M.toFixed(1)}, vAway);
  // Snow scatters light into the foot.
  vec3 kept = vec3(1.0) - mix(0.72, 0.4, uSnow) * near * dark * vec3(0.9, 0.96, 1.0);
  gl_FragColor = vec4(uSnow > 0.0 ? kept * mix(vec3(1.0), rimLight(vOut), uSnow * near) : kept, 1.0);
}
`;

export class StemFeet {
  readonly mesh: Mesh<InstancedBufferGeometry, ShaderMaterial>;
  private readonly buffer = new InstancedInterleavedBuffer(
    new Float32Array(FOOT_FLOATS * MOST_FEET),
    FOOT_FLOATS,
  );
  private crowns: Crowns = new Float32Array(0);
  private readonly chosenAt = { x: Number.NaN, z: Number.NaN };

  constructor() {
    const geometry = new InstancedBufferGeometry();
    const square = new PlaneGeometry(2, 2);
    geometry.setIndex(square.index);
    geometry.setAttribute("position", square.getAttribute("position"));
    geometry.setAttribute("aFoot", new InterleavedBufferAttribute(this.buffer, 4, 0));
    geometry.setAttribute("aSlope", new InterleavedBufferAttribute(this.buffer, 2, 4));
    geometry.instanceCount = 0;
    this.buffer.setUsage(DynamicDrawUsage);
    const { uSunFlat, uSunWorld } = air;
    const material = new ShaderMaterial({
      uniforms: { uSnow: seasonal.uSnow, uSunFlat, uSunWorld },
      vertexShader: FOOT_VERTEX,
      fragmentShader: FOOT_FRAGMENT,
      blending: MultiplyBlending,
      premultipliedAlpha: true,
      transparent: true,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: -2,
      polygonOffsetUnits: -8,
      side: DoubleSide,
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.matrixAutoUpdate = false;
  }

  /** Where the stems stand. */
  shelter(crowns: Crowns): void {
    this.crowns = crowns;
    this.chosenAt.x = Number.NaN;
  }

  /** Follows the camera. */
  update(eye: Vector3): void {
    if (Math.hypot(eye.x - this.chosenAt.x, eye.z - this.chosenAt.z) < MOVED_M) return;
    this.chosenAt.x = eye.x;
    this.chosenAt.z = eye.z;
    const { crowns } = this;
    const out = this.buffer.array as Float32Array;
    let count = 0;
    for (let at = 0; at < crowns.length && count < MOST_FEET; at += CROWN_FLOATS) {
      const [x, z] = [crowns[at], crowns[at + 2]];
      if (Math.hypot(x - eye.x, z - eye.z) > REACH_M + MOVED_M) continue;
      const half_m = Math.max(LEAST_WIDTH_M, WIDTH_SHARE * crowns[at + 4]);
      out.set([x, groundHeight_m(x, z), z, half_m, ...slopeAt(x, z, SLOPE_M)], FOOT_FLOATS * count++);
    }
    this.mesh.geometry.instanceCount = count;
    this.buffer.clearUpdateRanges();
    this.buffer.addUpdateRange(0, FOOT_FLOATS * count);
    this.buffer.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
