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

const TURN_RAD = "6.2831853";

/** GLSL: `leafAngle(random, wind_m_s, time_s)` in rad, `leafAxis(random)`, and `turned(arm, axis, angle)` (Rodrigues). */
export const LEAF_FLUTTER = /* glsl */ `
#ifdef LEAVES
float leafAngle(float own, float wind, float time) {
  float hz = ${SLOWEST_HZ.toFixed(1)} + ${(FASTEST_HZ - SLOWEST_HZ).toFixed(1)} * fract(17.3 * own);
  float lull = 0.6 + 0.4 * sin(0.9 * time + 50.0 * own);
  float amplitude = ${RAD_PER_M_S} * min(wind, ${FULL_AT_M_S.toFixed(1)}) * lull;
  return amplitude * sin(${TURN_RAD} * (hz * time + 7.1 * own));
}
vec3 leafAxis(float own) {
  float heading = ${TURN_RAD} * fract(57.0 * own);
  return 0.9119 * vec3(cos(heading), 0.45, sin(heading));
}
vec3 turned(vec3 arm, vec3 axis, float angle) {
  float c = cos(angle);
  return arm * c + cross(axis, arm) * sin(angle) + axis * (dot(axis, arm) * (1.0 - c));
}
#endif
`;
