/** Wind pressure on a tree, computed from the wind speed, and its relation to the sampled range of a table. */
import {
  HALF_AIR_DENSITY_KG_M3,
  PRESSURE_COMPRESSION,
  STREAMLINING_PRESSURE_PA,
  STREAMLINING_SPEED_M_S,
} from "../constants";
import type { Output, Places } from "./frame";

/**
 * Effective dynamic pressure (Pa): ½ρU² up to 5 m/s, growing as U^exponent beyond (streamlining). Here and below
 * `exponent` is `streamlined_exponent` of the tree's table, 1 … 2; at 2 the law is one parabola.
 */
export function dynamicPressure(speedMS: number, exponent: number): number {
  if (speedMS <= STREAMLINING_SPEED_M_S) return HALF_AIR_DENSITY_KG_M3 * speedMS * speedMS;
  return STREAMLINING_PRESSURE_PA * (speedMS / STREAMLINING_SPEED_M_S) ** exponent;
}

/** Inverse of `dynamicPressure`: the speed (m/s) of a dynamic pressure (Pa). */
export function speedOfPressure_m_s(pressure_pa: number, exponent: number): number {
  if (pressure_pa <= STREAMLINING_PRESSURE_PA) return Math.sqrt(pressure_pa / HALF_AIR_DENSITY_KG_M3);
  return STREAMLINING_SPEED_M_S * (pressure_pa / STREAMLINING_PRESSURE_PA) ** (1 / exponent);
}

/** Pressure (Pa) over speed (m/s). */
export function pressurePerSpeed(speedMS: number, exponent: number): number {
  if (speedMS <= STREAMLINING_SPEED_M_S) return HALF_AIR_DENSITY_KG_M3 * speedMS;
  const start = HALF_AIR_DENSITY_KG_M3 * STREAMLINING_SPEED_M_S;
  return start * (speedMS / STREAMLINING_SPEED_M_S) ** (exponent - 1);
}

/** Converts velocities (m/s), multiplied by the height factor if given, to pressure vectors (Pa). */
export function pressureOfVelocity(
  velocityX: Float64Array,
  velocityZ: Float64Array,
  outX: Output,
  outZ: Output,
  exponent: number,
  factor?: Places,
): void {
  for (let i = 0; i < outX.length; i++) {
    const f = factor ? factor[i] : 1;
    const vx = velocityX[i] * f;
    const vz = velocityZ[i] * f;
    const perSpeed = pressurePerSpeed(Math.sqrt(vx * vx + vz * vz), exponent);
    outX[i] = perSpeed * vx;
    outZ[i] = perSpeed * vz;
  }
}

/** Wind speed at a height relative to the reference height (power law above a canopy). */
export function heightFactor(height_m: number, exponent: number, referenceHeight_m: number): number {
  return (height_m / referenceHeight_m) ** exponent;
}

/** Pressure over the strongest sampled one, compressed where it is above 1: it grows with the logarithm. */
export const compressed = (ratio: number): number =>
  ratio <= 1 ? ratio : 1 + PRESSURE_COMPRESSION * Math.log(1 + (ratio - 1) / PRESSURE_COMPRESSION);

/**
 * Factor that compresses a pressure to the range of a table, `ratio` times its strongest sampled one, in a wind whose
 * strongest gusts are `strongest` times that. The wind is scaled as a whole: if only its gusts were compressed, a storm
 * would sway trees less than a breeze. What exceeds even the strongest gusts is compressed in turn.
 */
export function compression(ratio: number, strongest: number): number {
  const range = Math.max(strongest, 1);
  const most = compressed(range);
  return ratio > range ? (most * compressed(ratio / range)) / ratio : most / range;
}
