/**
 * Flutter of leaves: each turns about its petiole, at its own frequency, with the local gust. The frequencies are those of
 * leaves in wind tunnels, 3 to 8 Hz (assumed; unchecked), the amplitude grows with the wind speed.
 */

/** Frequencies of the leaves, Hz. */
export const SLOWEST_HZ = 3;
export const FASTEST_HZ = 8;
/** Amplitude per wind speed, rad per m/s, up to a speed. */
export const RAD_PER_M_S = 0.035;
export const FULL_AT_M_S = 16;

/** The amplitude swells and falls about its mean, at this rate. */
export const LULL_MEAN = 0.6;
export const LULL_SWING = 0.4;
export const LULL_RAD_S = 0.9;
/** How far the clock is ahead per metre along x and z, s: trees side by side do not flutter alike. */
export const AHEAD_X_S_PER_M = 0.7;
export const AHEAD_Z_S_PER_M = 1.1;
/** Factors that spread the random number of a leaf to its frequency, phase, lull and axis; the last two are whole numbers. */
export const HZ_SPREAD = 17.3;
export const PHASE_SPREAD = 7.1;
export const LULL_SPREAD = 50;
export const HEADING_SPREAD = 57;
/** Rise of the axis over its horizontal part, and the factor that makes its length 1. */
export const AXIS_RISE = 0.45;
export const AXIS_FACTOR = 0.9119;

const TURN_RAD = "6.2831853";

/** GLSL: `leafAngle(random, wind_m_s, time_s)` in rad, `leafAxis(random)`, and `turned(arm, axis, angle)` (Rodrigues). */
export const LEAF_FLUTTER = /* glsl */ `
#ifdef LEAVES
float leafAngle(float own, float wind, float time) {
  float hz = ${SLOWEST_HZ.toFixed(1)} + ${(FASTEST_HZ - SLOWEST_HZ).toFixed(1)} * fract(${HZ_SPREAD} * own);
  float lull = ${LULL_MEAN} + ${LULL_SWING} * sin(${LULL_RAD_S} * time + ${LULL_SPREAD}.0 * own);
  float amplitude = ${RAD_PER_M_S} * min(wind, ${FULL_AT_M_S.toFixed(1)}) * lull;
  return amplitude * sin(${TURN_RAD} * (hz * time + ${PHASE_SPREAD} * own));
}
vec3 leafAxis(float own) {
  float heading = ${TURN_RAD} * fract(${HEADING_SPREAD}.0 * own);
  return ${AXIS_FACTOR} * vec3(cos(heading), ${AXIS_RISE}, sin(heading));
}
vec3 turned(vec3 arm, vec3 axis, float angle) {
  float c = cos(angle);
  return arm * c + cross(axis, arm) * sin(angle) + axis * (dot(axis, arm) * (1.0 - c));
}
#endif
`;
