/** Snow driven past the camera in a winter storm: flakes in a box that wraps around the eye, in one draw call. */

import { hashUnit } from "galewood/random";
import {
  BufferAttribute,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  ShaderMaterial,
  Vector3,
} from "three";
import type { Quality } from "../quality";
import { snowShare } from "../sky/weather";
import type { Season } from "./season";
import { seasonal } from "./seasonal";

const MAX_FLAKES: Record<Quality, number> = { low: 700, medium: 2600, high: 5000 };
const BOX_M = new Vector3(30, 16, 30);
const FALL_M_S = 1.3;
/** Speed of the air near the ground relative to the wind. */
const AIR_SPEED_RATIO = 0.6;

const vertexShader = /* glsl */ `
attribute vec4 aSeed;
uniform vec3 uTravel;
uniform vec3 uSpeed;
uniform float uClock;
varying vec2 vAt;
varying float vFade;
const vec3 BOX = vec3(${BOX_M.toArray()
  .map((side) => side.toFixed(1))
  .join(", ")});
void main() {
  // Flakes differ in speed; each wraps on its own.
  vec3 place = aSeed.xyz * BOX + uTravel * (0.8 + 0.4 * aSeed.w);
  place += 0.35 * sin(uClock * (1.0 + aSeed.wxy) + 40.0 * aSeed.zyx);
  vec3 away = mod(place - cameraPosition + 0.5 * BOX, BOX) - 0.5 * BOX;
  vec3 centre = (viewMatrix * vec4(cameraPosition + away, 1.0)).xyz;
  // A streak along the motion, as an exposure of 1/60 s records it.
  vec2 streak = (viewMatrix * vec4(uSpeed, 0.0)).xy * 0.016;
  float size = mix(0.008, 0.02, aSeed.w);
  vec2 along = normalize(streak + 1e-5);
  vec2 corner = position.x * size * vec2(along.y, -along.x) + position.y * (size * along + 0.5 * streak);
  vAt = position.xy;
  vec3 edge = abs(away) / (0.5 * BOX);
  vFade = (1.0 - smoothstep(0.7, 1.0, max(edge.x, edge.z))) * smoothstep(0.6, 1.6, -centre.z);
  gl_Position = projectionMatrix * vec4(centre + vec3(corner, 0.0), 1.0);
}
`;

const fragmentShader = /* glsl */ `
uniform vec3 uSunColour;
uniform vec3 uSkyColour;
varying vec2 vAt;
varying float vFade;
void main() {
  float soft = (1.0 - dot(vAt, vAt)) * vFade;
  if (soft <= 0.02) discard;
  gl_FragColor = vec4((uSkyColour + 0.25 * uSunColour) * 0.5, 0.9 * min(1.0, 1.6 * soft));
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;

export class Snowfall {
  readonly mesh: Mesh<InstancedBufferGeometry, ShaderMaterial>;
  private readonly travel = new Vector3();
  private readonly speed = new Vector3();
  private readonly clock = { value: 0 };
  private most = 0;

  constructor(quality: Quality) {
    const { uSunColour, uSkyColour } = seasonal;
    const uniforms = {
      uSunColour,
      uSkyColour,
      uTravel: { value: this.travel },
      uSpeed: { value: this.speed },
      uClock: this.clock,
    };
    const material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      uniforms,
      transparent: true,
      depthWrite: false,
    });
    this.mesh = new Mesh(new InstancedBufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
    this.mesh.renderOrder = 20;
    this.setQuality(quality);
  }

  setQuality(quality: Quality): void {
    const most = MAX_FLAKES[quality];
    if (most === this.most) return;
    this.most = most;
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute(
      "position",
      new BufferAttribute(Float32Array.from([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3),
    );
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const seeds = Float32Array.from({ length: 4 * most }, (_, i) => hashUnit(59, i));
    geometry.setAttribute("aSeed", new InstancedBufferAttribute(seeds, 4));
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
  }

  /** Lets the snow drift for dt_s. */
  advance(dt_s: number, wind_m_s: { x: number; z: number }, season: Season): void {
    this.speed.set(AIR_SPEED_RATIO * wind_m_s.x, -FALL_M_S, AIR_SPEED_RATIO * wind_m_s.z);
    this.travel.addScaledVector(this.speed, dt_s);
    this.clock.value += dt_s;
    const flakes = Math.round(this.most * snowShare(Math.hypot(wind_m_s.x, wind_m_s.z), season));
    this.mesh.geometry.instanceCount = flakes;
    this.mesh.visible = flakes > 0;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
