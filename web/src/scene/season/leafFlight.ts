/** Paths of leaves that the wind tears off: functions of their age, the same here and in the shader. Pure. */
import { hashUnit } from "galewood/random";
import type { Season } from "./season";

export interface Flight {
  /** Where the leaf comes off, m. */
  readonly x: number;
  readonly y: number;
  readonly z: number;
  /** Velocity at which it is carried, m/s. */
  readonly vx: number;
  readonly vz: number;
  /** Age at which it lands, s, and height of the ground there, m. */
  readonly lands_s: number;
  readonly ground_m: number;
  /** Random number, 0 to 1. */
  readonly seed: number;
}

/** A leaf reaches the speed of the air within this time, s. */
const PICKED_UP_S = 0.45;
/** Speed of the air between the trees relative to the wind above them. */
const AIR_SPEED_RATIO = 0.62;
/** Rate of fall of a tumbling leaf, m/s; of a broad leaf in still air, estimated. */
const FALL_M_S = [1, 1.9] as const;
/** Strong wind keeps leaves aloft longer: share of the wind speed that is lost to the fall. */
const LIFT_SPEED_SHARE = 0.025;
const SWERVE_M = 0.55;
/** Gusts lift a leaf by up to this height per speed of the air, m per m/s. */
const LOFT_S = 0.3;
/** A leaf on the ground stays for a while and then disappears. */
export const REST_S = 3.5;
/** Landed leaves lie this far above the ground, so that grass does not swallow them. */
const LYING_M = 0.03;
/** The path is followed to the ground in steps of this length, s. */
const STEP_S = 0.3;
const LONGEST_S = 60;
const SHORTEST_S = 0.3;

/** Speed (m/s) at which leaves begin to come off, speed of a full storm, and number of leaves relative to autumn. */
const LEAF_FALL_RANGES: Record<Season, readonly [from: number, full: number, share: number]> = {
  spring: [6, 20, 0.55],
  summer: [8, 20, 0.65],
  autumn: [2, 18, 1],
  winter: [0, 1, 0],
};

/** Share of the largest number of flying leaves, by wind speed and season. */
export function looseShare(speed_m_s: number, season: Season): number {
  const [from, full, share] = LEAF_FALL_RANGES[season];
  const t = Math.min(1, Math.max(0, (speed_m_s - from) / (full - from)));
  return share * t ** 1.5;
}

const lostIn = (age_s: number) => PICKED_UP_S * (1 - Math.exp(-age_s / PICKED_UP_S));

/** Position of a leaf at an age; afterwards it lies where it landed. */
export function leafAt(flight: Flight, age_s: number): { x: number; y: number; z: number } {
  const age = Math.min(age_s, flight.lands_s);
  const share = age / flight.lands_s;
  const carried = age - lostIn(age);
  const free = share * (1 - share) * 4;
  const beat = 6.2832 * flight.seed + age * (2.1 + 1.7 * flight.seed);
  const swerve = SWERVE_M * free * Math.sin(beat);
  const speed = Math.hypot(flight.vx, flight.vz) + 1e-6;
  const loft = LOFT_S * speed * ((13.7 * flight.seed) % 1) ** 2;
  return {
    x: flight.x + flight.vx * carried - (swerve * flight.vz) / speed,
    y: flight.y + (flight.ground_m + LYING_M - flight.y) * share + loft * free,
    z: flight.z + flight.vz * carried + (swerve * flight.vx) / speed,
  };
}

/** The same path in GLSL: from.xyz; flight: velocity, age at landing, height of the ground there. */
export const LEAF_PATH = /* glsl */ `
vec3 leafAt(vec3 from, vec4 flight, float seed, float since) {
  float age = clamp(since, 0.0, flight.z);
  float part = age / flight.z;
  float carried = age - ${PICKED_UP_S.toFixed(3)} * (1.0 - exp(-age / ${PICKED_UP_S.toFixed(3)}));
  float swerve = ${SWERVE_M.toFixed(3)} * part * (1.0 - part) * 4.0 * sin(6.2832 * seed + age * (2.1 + 1.7 * seed));
  float loft = fract(13.7 * seed);
  loft *= ${LOFT_S.toFixed(3)} * length(flight.xy) * loft * 4.0 * part * (1.0 - part);
  vec2 across = vec2(-flight.y, flight.x) / (length(flight.xy) + 1e-6);
  vec2 level = from.xz + flight.xy * carried + swerve * across;
  return vec3(level.x, mix(from.y, flight.w + ${LYING_M.toFixed(3)}, part) + loft, level.y);
}
`;

/** The flight of leaf number `count` from a place, in a wind. Ends on the ground and stays above it on the way. */
export function flightFrom(
  from: { x: number; y: number; z: number },
  wind_m_s: { x: number; z: number },
  count: number,
  groundHeight_m: (x: number, z: number) => number,
): Flight {
  const at = (channel: number) => hashUnit(83, count, channel);
  const speed = Math.hypot(wind_m_s.x, wind_m_s.z);
  // Gusts differ from leaf to leaf in strength and direction.
  const strength = AIR_SPEED_RATIO * (0.7 + 0.6 * at(0));
  const turn = 0.5 * (at(1) - 0.5);
  const vx = strength * (wind_m_s.x * Math.cos(turn) - wind_m_s.z * Math.sin(turn));
  const vz = strength * (wind_m_s.x * Math.sin(turn) + wind_m_s.z * Math.cos(turn));
  const fall = (FALL_M_S[0] + (FALL_M_S[1] - FALL_M_S[0]) * at(2)) / (1 + LIFT_SPEED_SHARE * speed);
  const flight: Flight = { ...from, vx, vz, lands_s: from.y / fall, ground_m: 0, seed: at(3) };
  return landing(flight, fall, groundHeight_m);
}

/** Follows the path, without its swerve, until it meets the ground. */
function landing(flight: Flight, fall_m_s: number, groundHeight_m: (x: number, z: number) => number): Flight {
  const place = (age_s: number) => {
    const carried = age_s - lostIn(age_s);
    return { x: flight.x + flight.vx * carried, z: flight.z + flight.vz * carried };
  };
  const above_m = (age_s: number) => {
    const { x, z } = place(age_s);
    return flight.y - fall_m_s * age_s - groundHeight_m(x, z);
  };
  let [low, high] = [0, STEP_S];
  while (above_m(high) > 0 && high < LONGEST_S) [low, high] = [high, high + STEP_S];
  for (let k = 0; k < 8; k++) {
    const middle = 0.5 * (low + high);
    if (above_m(middle) > 0) low = middle;
    else high = middle;
  }
  const { x, z } = place(high);
  return { ...flight, lands_s: Math.max(SHORTEST_S, high), ground_m: groundHeight_m(x, z) };
}
