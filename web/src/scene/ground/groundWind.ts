/**
 * How far the wind bows grass around the camera, as a texture: the gusts that pass through the crowns bow grass, ferns and
 * shrubs too.
 * A lattice that stays in place while the camera moves.
 */
import { meanVelocity_m_s, type WindField } from "galewood/wind";
import { DataTexture, DataUtils, HalfFloatType, LinearFilter, RGFormat, Vector3 } from "three";

const SIDE_PLACES = 20;
const SPACING_M = 5;
/** Mean wind among the plants, relative to that above the trees: a glade is half sheltered (assumed). */
const GROUND_SHARE = 0.55;
/**
 * Gusts among the plants over the mean wind there, relative to those above the trees: sweeps come down, and between them the air is
 * nearly still. Turbulence of 0.6 of the mean wind at the top of a forest is 1 and more near its ground (Raupach, Finnigan and
 * Brunet 1996); the factor is assumed.
 */
const GROUND_GUSTS = 1.8;
/** Wind, m/s, that bows a blade of grass by half of the largest lean, which is that of a flattened one (assumed). */
const HALF_LEAN_M_S = 5.5;
const MOST_LEAN_RAD = 1.4;

/** Lean of the tip of a blade of grass, rad, in a wind, m/s, above the trees: drag over the stiffness of the stalk. */
export function grassLean_rad(speed_m_s: number): number {
  const drag = (GROUND_SHARE * speed_m_s) ** 2;
  return (MOST_LEAN_RAD * drag) / (drag + HALF_LEAN_M_S ** 2);
}

/** Tremble of a blade in its own eddies, rad; the slowest and how much faster the fastest is, rad/s; largest lean (assumed). */
const TREMBLE_RAD = 0.16;
const TREMBLE_RAD_S = [9, 6] as const;
const FLAT_RAD = 1.55;

/**
 * Lean of the tip of one blade, rad, where grass leans by `strength_rad`; `own`: its random number. The stronger the wind, the more
 * it whips, at a second frequency. As in `BLADE_GLSL`.
 */
export function bladeLean_rad(strength_rad: number, own: number, time_s: number): number {
  const beat = time_s * (TREMBLE_RAD_S[0] + TREMBLE_RAD_S[1] * own) + 40 * own;
  const whip = Math.sin(beat) + strength_rad * Math.sin(2.7 * beat);
  const tremble = TREMBLE_RAD * Math.min(1, 2.5 * strength_rad) * whip;
  return Math.min(FLAT_RAD, strength_rad * (0.85 + 0.3 * own) + tremble);
}

/** `bladeLean(strength, own, seconds)`. */
export const BLADE_GLSL = /* glsl */ `
float bladeLean(float strength, float own, float seconds) {
  float beat = seconds * (${TREMBLE_RAD_S[0].toFixed(1)} + ${TREMBLE_RAD_S[1].toFixed(1)} * own) + 40.0 * own;
  float whip = sin(beat) + strength * sin(2.7 * beat);
  return min(${FLAT_RAD}, strength * (0.85 + 0.3 * own) + ${TREMBLE_RAD} * min(1.0, 2.5 * strength) * whip);
}
`;

/** Makes velocities (m/s) above the trees those whose gusts reach the ground, in place. */
export function sweepDown(mean_m_s: { x: number; z: number }, vx: Float64Array, vz: Float64Array): void {
  for (let i = 0; i < vx.length; i++) {
    vx[i] = mean_m_s.x + GROUND_GUSTS * (vx[i] - mean_m_s.x);
    vz[i] = mean_m_s.z + GROUND_GUSTS * (vz[i] - mean_m_s.z);
  }
}

/** `leanAt(place)`: lean of grass at a place (x, z), rad, along the wind (`grassLean_rad`). */
export const GROUND_WIND_PARS = /* glsl */ `
uniform sampler2D uGroundLean;
uniform vec3 uGroundLeanAt; // x and z of the edge of the first texel, m; 1 / m
vec2 leanAt(vec2 place) {
  return texture2D(uGroundLean, (place - uGroundLeanAt.xy) * uGroundLeanAt.z).rg;
}
`;

export class GroundWind {
  readonly data = new Uint16Array(2 * SIDE_PLACES ** 2);
  private readonly texture = new DataTexture(this.data, SIDE_PLACES, SIDE_PLACES, RGFormat, HalfFloatType);
  readonly uniforms = {
    uGroundLean: { value: this.texture },
    uGroundLeanAt: { value: new Vector3(0, 0, 1 / (SIDE_PLACES * SPACING_M)) },
  };
  readonly x = new Float64Array(SIDE_PLACES ** 2);
  readonly z = new Float64Array(SIDE_PLACES ** 2);
  private readonly vx = new Float64Array(SIDE_PLACES ** 2);
  private readonly vz = new Float64Array(SIDE_PLACES ** 2);

  constructor() {
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearFilter;
  }

  /** Takes the wind of a moment around a position. */
  update(field: WindField, time_s: number, eye: { x: number; z: number }): void {
    const [column, row] = [Math.round(eye.x / SPACING_M), Math.round(eye.z / SPACING_M)];
    for (let i = 0; i < this.x.length; i++) {
      this.x[i] = (column + (i % SIDE_PLACES) - SIDE_PLACES / 2) * SPACING_M;
      this.z[i] = (row + Math.floor(i / SIDE_PLACES) - SIDE_PLACES / 2) * SPACING_M;
    }
    // The middle of the first texel lies at the first place.
    this.uniforms.uGroundLeanAt.value.setX(this.x[0] - SPACING_M / 2).setY(this.z[0] - SPACING_M / 2);
    const moment = field.at(time_s);
    field.velocity(this.x, this.z, moment, this.vx, this.vz);
    sweepDown(meanVelocity_m_s(moment.wind), this.vx, this.vz);
    for (let i = 0; i < this.x.length; i++) {
      const speed = Math.hypot(this.vx[i], this.vz[i]);
      const lean_per_m_s = grassLean_rad(speed) / Math.max(speed, 1e-6);
      this.data[2 * i] = DataUtils.toHalfFloat(lean_per_m_s * this.vx[i]);
      this.data[2 * i + 1] = DataUtils.toHalfFloat(lean_per_m_s * this.vz[i]);
    }
    this.texture.needsUpdate = true;
  }

  dispose(): void {
    this.texture.dispose();
  }
}
