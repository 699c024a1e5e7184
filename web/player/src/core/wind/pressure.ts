/** Wind pressure on a tree, computed from the wind speed, and its relation to the sampled range of a table. */
import {
  HALF_AIR_DENSITY_KG_M3,
  PRESSURE_COMPRESSION,
  STREAMLINED_EXPONENT,
  STREAMLINING_PRESSURE_PA,
  STREAMLINING_SPEED_M_S,
} from "../constants";
import type { Output, Places } from "./frame";

/** Effective dynamic pressure (Pa): ½ρU² up to 5 m/s, growing as U^1.3 beyond (streamlining). */
export function dynamicPressure(speedMS: number): number {
  if (speedMS <= STREAMLINING_SPEED_M_S) return HALF_AIR_DENSITY_KG_M3 * speedMS * speedMS;
  return STREAMLINING_PRESSURE_PA * (speedMS / STREAMLINING_SPEED_M_S) ** STREAMLINED_EXPONENT;
}

/** Inverse of `dynamicPressure`: the speed (m/s) of a dynamic pressure (Pa). */
export function speedOfPressure_m_s(pressure_pa: number): number {
  if (pressure_pa <= STREAMLINING_PRESSURE_PA) return Math.sqrt(pressure_pa / HALF_AIR_DENSITY_KG_M3);
  return STREAMLINING_SPEED_M_S * (pressure_pa / STREAMLINING_PRESSURE_PA) ** (1 / STREAMLINED_EXPONENT);
}

/** Pressure (Pa) over speed (m/s). */
export function pressurePerSpeed(speedMS: number): number {
  if (speedMS <= STREAMLINING_SPEED_M_S) return HALF_AIR_DENSITY_KG_M3 * speedMS;
  const start = HALF_AIR_DENSITY_KG_M3 * STREAMLINING_SPEED_M_S;
  return start * (speedMS / STREAMLINING_SPEED_M_S) ** (STREAMLINED_EXPONENT - 1);
}

/** Converts velocities (m/s), multiplied by the height factor if given, to pressure vectors (Pa). */
export function pressureOfVelocity(
  velocityX: Float64Array,
  velocityZ: Float64Array,
  outX: Output,
  outZ: Output,
  factor?: Places,
): void {
  for (let i = 0; i < outX.length; i++) {
    const f = factor ? factor[i] : 1;
    const vx = velocityX[i] * f;
    const vz = velocityZ[i] * f;
    const perSpeed = pressurePerSpeed(Math.sqrt(vx * vx + vz * vz));
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

/**
 * Clamps pressures in place to the largest sampled magnitude and keeps their direction: beyond it every record would
 * be equally wrong.
 */
export function limitPressure(pressureX: Output, pressureZ: Output, peak_pa: number): void {
  for (let i = 0; i < pressureX.length; i++) {
    const strength = Math.sqrt(pressureX[i] ** 2 + pressureZ[i] ** 2);
    if (strength <= peak_pa) continue;
    pressureX[i] *= peak_pa / strength;
    pressureZ[i] *= peak_pa / strength;
  }
}

/** Share (0..1) of the pressures that are within the sampled range. */
export function coverage(pressureX: Places, pressureZ: Places, peak_pa: number): number {
  const count = pressureX.length;
  if (count === 0) return 1;
  let inside = 0;
  for (let i = 0; i < count; i++) {
    if (pressureX[i] * pressureX[i] + pressureZ[i] * pressureZ[i] <= peak_pa * peak_pa) inside++;
  }
  return inside / count;
}
