/** Sky dome: a clear gradient, the sun's glow and drifting clouds; its horizon is the colour of the haze. */
import { BackSide, Mesh, ShaderMaterial, SphereGeometry, Vector2 } from "three";
import { AIR_PARS, air } from "./air";
import type { Pictures } from "./pictures";

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
uniform sampler2D uNoise;
${AIR_PARS}
float cloudBody(vec2 plane) {
  vec4 wide = texture2D(uNoise, plane * 0.062 + 0.41);
  vec4 small = texture2D(uNoise, plane * 0.21 + wide.ba * 0.06);
  return 0.62 * wide.r + 0.3 * small.g + 0.08 * texture2D(uNoise, plane * 0.83).b;
}
vec3 clearSky(vec3 direction) {
  float up = max(direction.y, 0.0);
  vec3 sky = mix(vec3(0.55, 0.76, 0.93), vec3(0.19, 0.45, 0.78), smoothstep(0.06, 0.62, up));
  sky = mix(hazeColour(direction), sky, smoothstep(-0.01, 0.2, up));
  float sun = max(dot(direction, uSunWorld), 0.0);
  return sky + vec3(1.0, 0.86, 0.62) * (0.16 * pow(sun, 12.0) + 0.5 * pow(sun, 900.0));
}
void main() {
  vec3 direction = normalize(vDirection);
  vec3 colour = clearSky(direction);
  float up = direction.y;
  if (up > 0.015) {
    vec2 plane = direction.xz / (up + 0.11) * vec2(0.8, 1.2) + uDrift;
    float body = cloudBody(plane);
    float cover = smoothstep(0.46, 0.63, body) * smoothstep(0.015, 0.14, up);
    float shade = smoothstep(-0.06, 0.14, cloudBody(plane + uSunWorld.xz * 0.5) - body + 0.03);
    vec3 cloud = mix(vec3(1.0, 0.985, 0.965), vec3(0.76, 0.81, 0.88), 0.7 * shade);
    cloud = mix(hazeColour(direction), cloud, smoothstep(0.0, 0.26, up));
    colour = mix(colour, cloud, 0.92 * cover);
  }
  gl_FragColor = vec4(colour, 1.0);
}
`;

export class Sky {
  readonly mesh: Mesh<SphereGeometry, ShaderMaterial>;
  private readonly drift = new Vector2(0, 0);

  constructor(pictures: Pictures) {
    const material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      side: BackSide,
      depthWrite: false,
      toneMapped: false,
      uniforms: { ...air, uDrift: { value: this.drift }, uNoise: { value: pictures.noise } },
    });
    this.mesh = new Mesh(new SphereGeometry(1, 32, 16), material);
    this.mesh.frustumCulled = false;
    // Last of the opaque things: only what stays open is shaded.
    this.mesh.renderOrder = 10;
  }

  /** Clouds drift with the wind of this step and stand still without it. */
  advance(dt_s: number, wind_m_s: { x: number; z: number }): void {
    this.drift.x -= wind_m_s.x * dt_s * 0.0012;
    this.drift.y -= wind_m_s.z * dt_s * 0.0012;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
