/** Editing wind documents. Pure. */
import { WIND_PRESETS } from "../constants";
import type { WindDocument } from "./document";

/** Gusts travel with the mean wind, but at least at this speed, so that a calm has no standing waves. */
const MIN_GUST_SPEED_M_S = 2;

export const gustSpeed_m_s = (mean_m_s: number): number => Math.max(MIN_GUST_SPEED_M_S, mean_m_s);

/** The four numbers that define a plain wind. */
export type PlainWind = Pick<WindDocument, "mean_speed_m_s" | "direction_deg" | "gustiness" | "seed">;

/** Turbulence, also within the crowns, that travels with the mean wind; all other fields have their defaults. */
export function plainWind({ mean_speed_m_s, direction_deg, gustiness, seed }: PlainWind): WindDocument {
  return {
    version: 1,
    model: "spectral",
    length_scale_m: WIND_PRESETS.still.length_scale_m,
    convection_speed_m_s: gustSpeed_m_s(mean_speed_m_s),
    mean_speed_m_s,
    direction_deg,
    gustiness,
    seed,
  };
}

/** Whether two documents have the same fields and values, in any order. */
export function sameWind(a: WindDocument, b: WindDocument): boolean {
  const names = new Set([...Object.keys(a), ...Object.keys(b)]) as Set<keyof WindDocument>;
  return [...names].every((name) => JSON.stringify(a[name]) === JSON.stringify(b[name]));
}

/** Changes the mean wind; the convection speed follows if it followed before. */
export function withMean(wind: WindDocument, mean_speed_m_s: number, direction_deg: number): WindDocument {
  const follows = wind.convection_speed_m_s === gustSpeed_m_s(wind.mean_speed_m_s);
  const convection_speed_m_s = follows ? gustSpeed_m_s(mean_speed_m_s) : wind.convection_speed_m_s;
  return { ...wind, mean_speed_m_s, direction_deg, convection_speed_m_s };
}

/** Changes some of the plain numbers. */
export function withPlain(wind: WindDocument, change: Partial<PlainWind>): WindDocument {
  const changed = { ...wind, ...change };
  return { ...changed, ...withMean(wind, changed.mean_speed_m_s, changed.direction_deg), ...change };
}

/** The document with its direction in [0, 360). */
export function withinTurn(wind: WindDocument): WindDocument {
  return { ...wind, direction_deg: wind.direction_deg - 360 * Math.floor(wind.direction_deg / 360) };
}

/** Mean wind as a vector in the world's ground plane. */
export function meanVelocity_m_s(wind: WindDocument): { x: number; z: number } {
  const heading = (wind.direction_deg * Math.PI) / 180;
  return { x: wind.mean_speed_m_s * Math.cos(heading), z: wind.mean_speed_m_s * Math.sin(heading) };
}
