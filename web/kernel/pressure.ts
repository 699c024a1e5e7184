// The pressure law of ../player/src/core/wind/pressure.ts in single precision, for four drag points at a time.

import { HALF_AIR_DENSITY_KG_M3, STREAMLINING_PRESSURE_PA, STREAMLINING_SPEED_M_S } from "./constants";

/** The sheltered speed at a pressure (Pa), quadratic up to STREAMLINING_PRESSURE_PA. */
function speedOf(pressure_pa: f32, exponent: f32): f32 {
  if (pressure_pa <= STREAMLINING_PRESSURE_PA) return sqrt(pressure_pa / HALF_AIR_DENSITY_KG_M3);
  return STREAMLINING_SPEED_M_S * Mathf.pow(pressure_pa / STREAMLINING_PRESSURE_PA, (1.0 as f32) / exponent);
}

/** Pressure over speed at a speed, linear up to STREAMLINING_SPEED_M_S. */
function perSpeed(speed_m_s: f32, exponent: f32): f32 {
  if (speed_m_s <= STREAMLINING_SPEED_M_S) return HALF_AIR_DENSITY_KG_M3 * speed_m_s;
  const ratio = Mathf.pow(speed_m_s / STREAMLINING_SPEED_M_S, exponent - (1.0 as f32));
  return HALF_AIR_DENSITY_KG_M3 * STREAMLINING_SPEED_M_S * ratio;
}

/** The sheltered speeds at four pressures (Pa). Weak wind takes no powers. */
// @ts-ignore: decorator
@inline
export function shelteredSpeeds(pressure_pa: v128, exponent: f32): v128 {
  let speed = f32x4.sqrt(f32x4.mul(pressure_pa, f32x4.splat((1.0 as f32) / HALF_AIR_DENSITY_KG_M3)));
  if (v128.any_true(f32x4.gt(pressure_pa, f32x4.splat(STREAMLINING_PRESSURE_PA)))) {
    speed = f32x4.replace_lane(speed, 0, speedOf(f32x4.extract_lane(pressure_pa, 0), exponent));
    speed = f32x4.replace_lane(speed, 1, speedOf(f32x4.extract_lane(pressure_pa, 1), exponent));
    speed = f32x4.replace_lane(speed, 2, speedOf(f32x4.extract_lane(pressure_pa, 2), exponent));
    speed = f32x4.replace_lane(speed, 3, speedOf(f32x4.extract_lane(pressure_pa, 3), exponent));
  }
  return speed;
}

/** Pressure over speed at four speeds (m/s). Slow air takes no powers. */
// @ts-ignore: decorator
@inline
export function perSpeeds(speed: v128, exponent: f32): v128 {
  let per = f32x4.mul(speed, f32x4.splat(HALF_AIR_DENSITY_KG_M3));
  if (v128.any_true(f32x4.gt(speed, f32x4.splat(STREAMLINING_SPEED_M_S)))) {
    per = f32x4.replace_lane(per, 0, perSpeed(f32x4.extract_lane(speed, 0), exponent));
    per = f32x4.replace_lane(per, 1, perSpeed(f32x4.extract_lane(speed, 1), exponent));
    per = f32x4.replace_lane(per, 2, perSpeed(f32x4.extract_lane(speed, 2), exponent));
    per = f32x4.replace_lane(per, 3, perSpeed(f32x4.extract_lane(speed, 3), exponent));
  }
  return per;
}
