/**
 * How far the wind bows grass around the camera, as a texture: the gusts that pass through the crowns bow grass, ferns and
 * shrubs too.
 * A lattice that stays in place while the camera moves.
 */
import type { WindField } from "galewood/wind";
import { DataTexture, DataUtils, HalfFloatType, LinearFilter, RGFormat, Vector3 } from "three";

const SIDE_PLACES = 20;
const SPACING_M = 5;
/** Mean wind among the plants, relative to that above the trees: a glade is half sheltered (assumed). */
const GROUND_SHARE = 0.55;
/** Wind, m/s, that bows a blade of grass by half of the largest lean, which is that of a flattened one (assumed). */
const HALF_LEAN_M_S = 5.5;
const MOST_LEAN_RAD = 1.4;

/** Lean of the tip of a blade of grass, rad, in a wind, m/s, above the trees: drag over the stiffness of the stalk. */
export function grassLean_rad(speed_m_s: number): number {
  const drag = (GROUND_SHARE * speed_m_s) ** 2;
  return (MOST_LEAN_RAD * drag) / (drag + HALF_LEAN_M_S ** 2);
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
    field.velocity(this.x, this.z, field.at(time_s), this.vx, this.vz);
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
