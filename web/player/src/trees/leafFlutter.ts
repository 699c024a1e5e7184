/**
 * Flutter of leaves: each turns about its petiole, at its own frequency, with the local gust. A petiole is a torsion spring, whose
 * stiffness is inversely proportional to its length; blades of a size flutter at 2 to 8 Hz. Flutter sets in at low speeds and then depends
 * little on the wind, which bends the leaves together (Tadrist and others 2018, https://doi.org/10.1098/rsif.2018.0010).
 */

/** Mean frequencies of the leaves of a tree, Hz: with petioles of a length, m, and the limits. */
const SLOWEST_HZ = 2;
const FASTEST_HZ = 8;
const SLOWEST_PETIOLE_M = 0.06;
/** That of leaves of which nothing is known. */
export const USUAL_HZ = 5;
/** Half the range of the frequencies of single leaves, relative to the mean one. */
export const HZ_RANGE = 0.3;
/** Amplitude in a strong wind, rad, and the speed, m/s, at which it is 63 % of that. */
export const MOST_RAD = 0.4;
export const ONSET_M_S = 5;

/** Mean frequency, Hz, of leaves with petioles of a length, m. */
export const leafFrequency_hz = (petiole_m: number): number =>
  Math.min(FASTEST_HZ, SLOWEST_HZ * Math.sqrt(SLOWEST_PETIOLE_M / Math.min(SLOWEST_PETIOLE_M, petiole_m)));

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

/** GLSL: `leafAngle(random, mean_hz, wind_m_s, time_s)` in rad, `leafAxis(random)`, and `turned(arm, axis, angle)` (Rodrigues). */
export const LEAF_FLUTTER = /* glsl */ `
#ifdef LEAVES
float leafAngle(float own, float mean, float wind, float time) {
  float hz = mean * (${1 - HZ_RANGE} + ${2 * HZ_RANGE} * fract(${HZ_SPREAD} * own));
  float lull = ${LULL_MEAN} + ${LULL_SWING} * sin(${LULL_RAD_S} * time + ${LULL_SPREAD}.0 * own);
  float amplitude = ${MOST_RAD} * (1.0 - exp(${-1 / ONSET_M_S} * wind)) * lull;
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
