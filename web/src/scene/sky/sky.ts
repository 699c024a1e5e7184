/** Sky dome: scattered light, the sun, and drifting clouds lit by both. */
import { BackSide, Color, Mesh, ShaderMaterial, SphereGeometry, Vector2 } from "three";
import type { Pictures } from "../textures/pictures";
import { AIR_PARS, air } from "./air";
import type { Atmosphere } from "./daytime";

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
uniform float uCover;
uniform vec3 uCloudSun;
uniform vec3 uCloudSky;
uniform sampler2D uNoise;
${AIR_PARS}
float cloudBody(vec2 plane) {
  vec4 wide = texture2D(uNoise, plane * 0.062 + 0.41);
  vec4 small = texture2D(uNoise, plane * 0.21 + wide.ba * 0.06);
  return 0.62 * wide.r + 0.3 * small.g + 0.08 * texture2D(uNoise, plane * 0.83).b;
}
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
    float edge = 0.78 - 0.5 * uCover;
    float cover = smoothstep(edge - 0.08, edge + 0.1, body) * smoothstep(0.015, 0.16, up);
    float shade = smoothstep(-0.06, 0.14, cloudBody(plane + uSunFlat * 0.5) - body + 0.03);
    // Towards the sun, light shines through thin clouds.
    float lining = (1.0 - cover) * pow(max(cosine, 0.0), 6.0);
    vec3 cloud = uCloudSun * (0.27 - 0.13 * shade + 0.55 * lining) + uCloudSky * (0.34 - 0.1 * shade);
    cloud = mix(hazeColour(direction), cloud, smoothstep(0.0, 0.3, up));
    colour = mix(colour, cloud, 0.93 * cover);
  }
  if (uMist.x > 0.0) colour = mix(hazeColour(direction), colour, exp(-mistDepth(direction, 4000.0)));
  gl_FragColor = vec4(colour, 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;

/** Drift of the clouds in units of their texture width. */
export interface Drift {
  x: number;
  y: number;
}

export class Sky {
  readonly mesh: Mesh<SphereGeometry, ShaderMaterial>;
  readonly drift = new Vector2(0, 0);

  constructor(pictures: Pictures) {
    const material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      side: BackSide,
      depthWrite: false,
      uniforms: {
        ...air,
        uDrift: { value: this.drift },
        uCover: { value: 0.5 },
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

  show({ cloudlight, skylight, clouds }: Atmosphere): void {
    const { uniforms } = this.mesh.material;
    uniforms.uCloudSun.value.setRGB(...cloudlight);
    uniforms.uCloudSky.value.setRGB(...skylight);
    uniforms.uCover.value = clouds;
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
