/** Haze: the same horizon colours for trees, ground and sky, warmer towards the sun. Display-referred. */
import { Color, Vector3 } from "three";

export const air = {
  uHaze: { value: new Color(0.72, 0.82, 0.9) },
  uHazeSun: { value: new Color(1.0, 0.93, 0.8) },
  /** Towards the sun, world frame. */
  uSunWorld: { value: new Vector3(0.5, 0.5, 0.5).normalize() },
  /** Extinction per metre. */
  uHazeDensity: { value: 0.0026 },
};

export const AIR_PARS = /* glsl */ `
uniform vec3 uHaze;
uniform vec3 uHazeSun;
uniform vec3 uSunWorld;
uniform float uHazeDensity;
vec3 hazeColour(vec3 direction) {
  float towardsSun = pow(max(dot(normalize(direction * vec3(1.0, 0.35, 1.0)), uSunWorld), 0.0), 5.0);
  return mix(uHaze, uHazeSun, 0.65 * towardsSun);
}
`;

/** Replaces three's fog, after tone mapping as there: needs vViewPosition. */
export const AIR_FRAGMENT = /* glsl */ `
vec3 airDirection = -normalize((vec4(vViewPosition, 0.0) * viewMatrix).xyz);
float airDistance = length(vViewPosition);
float clear = exp(-uHazeDensity * airDistance * (0.35 + 0.65 * smoothstep(20.0, 320.0, airDistance)));
gl_FragColor.rgb = mix(hazeColour(airDirection), gl_FragColor.rgb, clear);
`;
