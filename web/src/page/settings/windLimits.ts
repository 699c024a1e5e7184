/** Limits of the plain numbers of a wind, in the address and on the controls: those of the wind document, or narrower. */
import { FIELDS, type PlainWind } from "galewood/wind";
import type { Limits } from "./queryNumbers";

/** The strongest mean wind of the wind document. */
export const FASTEST_M_S = FIELDS.mean_speed_m_s.high;

export const WIND_LIMITS: Readonly<Record<keyof PlainWind, Limits>> = {
  mean_speed_m_s: { min: FIELDS.mean_speed_m_s.low, max: FASTEST_M_S, step: 0.1 },
  // One turn: the document also has negative directions.
  direction_deg: { min: 0, max: 359, step: 1 },
  gustiness: { min: FIELDS.gustiness.low, max: FIELDS.gustiness.high, step: 0.01 },
  // Fewer seeds than the document has, so that a slider can choose one.
  seed: { min: FIELDS.seed.low, max: 9999, step: 1 },
};
