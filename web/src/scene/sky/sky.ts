/** Sky dome: scattered light, the sun, and drifting clouds lit by both. */
import { BackSide, Color, Mesh, ShaderMaterial, SphereGeometry, Vector2, type Vector3 } from "three";
import type { Picture } from "../textures/paint";
import type { Pictures } from "../textures/pictures";
import { AIR_PARS, air } from "./air";
import { behindCloud, CLOUD_PARS, cloudEdge, EDGE_HALF_WIDTH } from "./cloudField";
import type { Atmosphere } from "./daytime";
import { closed, overcastRadiance } from "./weather";

/** Exposure of the clouds relative to the land, as for the clear sky. */
const CLOUD_EXPOSURE = 1.1;

const vertexShader = /* glsl */ `
varying vec3 vDirection;
void main() {
  vDirection = position;
  vec4 place = projectionMatrix * vec4(mat3(viewMatrix) * position, 1.0);
  gl_Position = place.xyww;
}
`;

const fragmentShader = /* glsl */ `
varying vec3 vDirection;
uniform vec2 uDrift;
uniform float uEdge;
uniform float uClosed;
uniform float uDark;
uniform vec3 uCloudSun;
uniform vec3 uCloudSky;
uniform vec3 uGrey;
uniform sampler2D uNoise;
${AIR_PARS}
${CLOUD_PARS}
void main() {
  vec3 direction = normalize(vDirection);
  float up = max(direction.y, 0.0);
  vec2 level = normalize(direction.xz + 1e-5);
  float cosine = dot(direction, uSunWorld);
  vec3 colour = skyLight(level, sqrt(asin(up) * 0.63662), cosine);
  float disc = smoothstep(0.99985, 0.99994, cosine);
  colour += uCloudSun * (18.0 * disc + 0.05 * pow(max(cosine, 0.0), 700.0));
  if (up > 0.015) {
    vec2 plane = direction.xz / (up + 0.11) * vec2(0.8, 1.2) + uDrift;
    float body = cloudBody(plane);
    float cover = smoothstep(uEdge - ${EDGE_HALF_WIDTH}, uEdge + ${EDGE_HALF_WIDTH}, body) * smoothstep(0.015, 0.16, up);
    float shade = smoothstep(-0.06, 0.14, cloudBody(plane + uSunFlat * 0.5) - body + 0.03);
    float thick = smoothstep(uEdge, uEdge + 0.34, body);
    // Towards the sun, light shines through thin clouds.
    float lining = (1.0 - cover) * pow(max(cosine, 0.0), 6.0);
    vec3 cloud = uCloudSun * (0.27 - 0.13 * shade + 0.55 * lining) + uCloudSky * (0.34 - 0.1 * shade);
    cloud *= 1.0 - 0.45 * thick * (1.0 - smoothstep(0.3, 0.6, uEdge));
    if (uClosed > 0.0) {
      // A closed cover: rolls with dark bases, and torn shreds below it that are darker still.
      float rolls = smoothstep(0.3, 0.68, body);
      float shreds = smoothstep(0.5, 0.72, cloudBody(plane * 1.9 + uDrift * 0.35 + 3.7));
      float light = (1.0 + 2.0 * up) / 3.0 * mix(1.2, 0.66 - 0.22 * uDark, rolls) * (1.0 - (0.12 + 0.3 * uDark) * shreds);
      cloud = mix(cloud, uGrey * light, uClosed);
    }
    cloud = mix(hazeColour(direction), cloud, smoothstep(0.0, 0.3, up));
    colour = mix(colour, cloud, mix(0.93, 1.0, uClosed) * cover);
  }
  if (uMist.x > 0.0) colour = mix(hazeColour(direction), colour, exp(-mistDepth(direction, 4000.0)));
  gl_FragColor = vec4(seenByNight(colour), 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;

export class Sky {
  readonly mesh: Mesh<SphereGeometry, ShaderMaterial>;
  readonly drift = new Vector2(0, 0);

  private readonly noise: Picture;

  constructor(pictures: Pictures) {
    this.noise = pictures.noisePicture;
    const material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      side: BackSide,
      depthWrite: false,
      uniforms: {
        ...air,
        uDrift: { value: this.drift },
        uEdge: { value: 0.5 },
        uClosed: { value: 0 },
        uDark: { value: 0 },
        uGrey: { value: new Color() },
        uCloudSun: { value: new Color() },
        uCloudSky: { value: new Color() },
        uNoise: { value: pictures.noise },
      },
    });
    this.mesh = new Mesh(new SphereGeometry(1, 32, 16), material);
    this.mesh.frustumCulled = false;
    // Drawn last of the opaque objects, so that only visible sky is shaded.
    this.mesh.renderOrder = 10;
  }

  show({ cloudlight, skylight, weather }: Atmosphere): void {
    const { uniforms } = this.mesh.material;
    uniforms.uCloudSun.value.setRGB(...cloudlight);
    uniforms.uCloudSky.value.setRGB(...skylight);
    uniforms.uEdge.value = cloudEdge(weather.cover);
    uniforms.uClosed.value = closed(weather);
    uniforms.uDark.value = weather.dark;
    // Radiance overhead of a closed cover with this irradiance.
    uniforms.uGrey.value.setRGB(...skylight).multiplyScalar(CLOUD_EXPOSURE * overcastRadiance(1));
  }

  /** How far a cloud hides the sun, 0 to 1. */
  behindCloud(sun: Vector3, cover: number): number {
    return behindCloud(this.noise, sun, this.drift, cover);
  }

  /** Moves the clouds with the wind of this step. */
  advance(dt_s: number, wind_m_s: { x: number; z: number }): void {
    this.drift.x -= wind_m_s.x * dt_s * 0.0012;
    this.drift.y -= wind_m_s.z * dt_s * 0.0012;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
