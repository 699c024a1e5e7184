/**
 * Gust fronts: single gusts that start at a place and travel with the wind, beside those of a document. Specified in
 * spec/formats/wind.md.
 */
import {
  FRONT_DEPTH_M,
  FRONT_GUST_SHARE,
  FRONT_LEAST_GUST_M_S,
  FRONT_LEAST_TRAVEL_M_S,
  FRONT_LIMITS,
  FRONT_RANGE_M,
  FRONT_RISE_S,
  FRONT_SPREAD,
  FRONT_TRAVEL_SHARE,
  FRONT_WIDTH_M,
  MOST_FRONTS,
} from "../constants";
import { WindError } from "./fields";
import type { Output, Places } from "./frame";

/** A gust front that started at a time and place, with the mean wind of that moment. */
export interface Front {
  readonly since_s: number;
  readonly x_m: number;
  readonly z_m: number;
  readonly direction_deg: number;
  readonly mean_speed_m_s: number;
}

const LIMITS: Readonly<Record<keyof Front, readonly [number, number]>> = FRONT_LIMITS;

/** Parses the fronts of a wind's state; throws WindError that names the field. */
export function parseFronts(value: unknown): Front[] {
  if (!Array.isArray(value) || value.length > MOST_FRONTS)
    throw new WindError("wind_state.fronts", `expected a list of at most ${MOST_FRONTS} fronts`);
  return value.map(parseFront);
}

function parseFront(value: unknown, index: number): Front {
  const path = `wind_state.fronts[${index}]`;
  if (typeof value !== "object" || value === null || Array.isArray(value))
    throw new WindError(path, "expected an object");
  const fields = value as Record<string, unknown>;
  for (const [name, [low, high]] of Object.entries(LIMITS)) {
    const number = fields[name];
    if (typeof number !== "number" || !(number >= low && number <= high))
      throw new WindError(`${path}.${name}`, `expected a number in ${brief(low)}..${brief(high)}`);
  }
  if (Object.keys(fields).length > Object.keys(LIMITS).length) throw new WindError(path, "unknown field");
  return fields as unknown as Front;
}

/** As Python's format "g" writes it. */
const brief = (value: number) =>
  Math.abs(value) < 1e6 ? String(value) : value.toExponential().replace(/e\+(\d)$/, "e+0$1");

/** Distance that a front has travelled at an age, m; null while it is not there. */
export function travelled_m({ mean_speed_m_s }: Front, age_s: number): number | null {
  const path_m = age_s * Math.max(FRONT_LEAST_TRAVEL_M_S, FRONT_TRAVEL_SHARE * mean_speed_m_s);
  return age_s <= 0 || path_m >= FRONT_RANGE_M ? null : path_m;
}

/** Half the width of a front that has travelled this far, and what is left of its strength (0..1). */
export const frontExtent = (path_m: number) => ({
  width_m: FRONT_WIDTH_M + FRONT_SPREAD * path_m,
  left: 1 - path_m / FRONT_RANGE_M,
});

/** Adds the velocity (m/s, world x and z) of the fronts at each position. */
export function addFronts(
  fronts: readonly Front[],
  x: Places,
  z: Places,
  time_s: number,
  outX: Output,
  outZ: Output,
): void {
  for (const front of fronts) {
    const age_s = time_s - front.since_s;
    const path_m = travelled_m(front, age_s);
    if (path_m !== null) addFront(front, age_s, path_m, x, z, outX, outZ);
  }
}

function addFront(
  front: Front,
  age_s: number,
  path_m: number,
  x: Places,
  z: Places,
  outX: Output,
  outZ: Output,
): void {
  const heading = (front.direction_deg * Math.PI) / 180;
  const cos = Math.cos(heading);
  const sin = Math.sin(heading);
  const { width_m, left } = frontExtent(path_m);
  const gust =
    (FRONT_LEAST_GUST_M_S + FRONT_GUST_SHARE * front.mean_speed_m_s) *
    Math.min(age_s / FRONT_RISE_S, 1) *
    left;
  for (let i = 0; i < outX.length; i++) {
    const dx = x[i] - front.x_m;
    const dz = z[i] - front.z_m;
    const along = (dx * cos + dz * sin - path_m) / FRONT_DEPTH_M;
    const across = (dz * cos - dx * sin) / width_m;
    const speed = gust * bump(along) * bump(across);
    outX[i] += speed * cos;
    outZ[i] += speed * sin;
  }
}

/** (1 − s²)² for |s| < 1, otherwise 0. */
function bump(s: number): number {
  const rest = Math.max(1 - s * s, 0);
  return rest * rest;
}
