/**
 * State of a forest's wind over time: a change of the document is a smooth transition. Same arithmetic as
 * precompute/galewood/wind/, which gives the reasons.
 */

import { FIELDS, parseWind, type ResolvedWind, resolveWind, type WindDocument, WindError } from "./document";
import { FRONT_LIFE_S, type Front, MOST_FRONTS, parseFronts } from "./fronts";

export const GLIDE_S = 0.6;

/** A transition from one wind document to another since a given time; serializable. */
export interface WindState {
  readonly before: WindDocument;
  readonly wind: WindDocument;
  readonly since_s: number;
  /** Distance travelled at `since_s`, in length scales. */
  readonly travel: number;
  /** Gust fronts on their way, the oldest first. */
  readonly fronts?: readonly Front[];
}

/** The wind at one time. `before` and `wind` differ only while one model or seed fades into another. */
export interface Moment {
  readonly before: ResolvedWind;
  readonly wind: ResolvedWind;
  readonly time_s: number;
  readonly travel: number;
  /** Weight of `wind`; the rest is `before`. */
  readonly share: number;
}

type Gliding = Exclude<keyof typeof FIELDS, "seed" | "beta" | "direction_deg">;
const GLIDING = Object.keys(FIELDS).filter(
  (name) => name !== "seed" && name !== "beta" && name !== "direction_deg",
) as Gliding[];

/** The state of a constant wind that started at time 0. */
export function steady(wind: WindDocument): WindState {
  return { before: wind, wind, since_s: 0, travel: 0 };
}

/** Parses a received state; throws WindError that names the field. */
export function parseState(value: unknown): WindState {
  if (typeof value !== "object" || value === null) throw new WindError("wind_state", "expected an object");
  const fields = value as Record<string, unknown>;
  for (const name of ["since_s", "travel"]) {
    const number = fields[name];
    if (typeof number !== "number" || !(Math.abs(number) <= 1e9)) {
      throw new WindError(`wind_state.${name}`, "expected a number in -1e9..1e9");
    }
  }
  const { since_s, travel } = fields as { since_s: number; travel: number };
  const fronts = parseFronts(fields.fronts ?? []);
  const winds = { before: parseWind(fields.before), wind: parseWind(fields.wind) };
  return { ...winds, since_s, travel, ...(fronts.length > 0 && { fronts }) };
}

/** Starts a transition from the current wind to another document. */
export function changeWind(state: WindState, wind: WindDocument, time_s: number): WindState {
  const now = windAt(state, time_s);
  const before = strip(now.share < 0.5 ? now.before : now.wind);
  const { fronts } = state;
  return { before, wind, since_s: time_s, travel: now.travel, ...(fronts && { fronts }) };
}

/** The same wind with a gust front that starts at a place at this time; old fronts are dropped. */
export function withFront(state: WindState, x_m: number, z_m: number, time_s: number): WindState {
  const { direction_deg, mean_speed_m_s } = windAt(state, time_s).wind;
  const kept = (state.fronts ?? []).filter(({ since_s }) => time_s - since_s < FRONT_LIFE_S);
  const front = { since_s: time_s, x_m, z_m, direction_deg, mean_speed_m_s };
  return { ...state, fronts: [...kept, front].slice(-MOST_FRONTS) };
}

/** Removes the fields that the model does not use, so that the document is valid. */
function strip(wind: ResolvedWind): WindDocument {
  const { waves, ...rest } = wind;
  const fields = FIELDS as Record<string, { models: readonly string[] }>;
  const own = Object.entries(rest).filter(([name]) => fields[name]?.models.includes(wind.model) ?? true);
  return {
    ...Object.fromEntries(own),
    ...(wind.model === "cosine" ? { waves } : {}),
  } as unknown as WindDocument;
}

/** The wind at a time. */
export function windAt(state: WindState, time_s: number): Moment {
  const from = resolveWind(state.before);
  const to = resolveWind(state.wind);
  const since = time_s - state.since_s;
  const t = Math.min(Math.max(since / GLIDE_S, 0), 1);
  const share = t * t * (3 - 2 * t);
  const oldRate = from.convection_speed_m_s / from.length_scale_m;
  const newRate = to.convection_speed_m_s / to.length_scale_m;
  // integral of the smoothstep: t³ − t⁴/2, and ½ at the end
  const glided_s = GLIDE_S * t * t * t * (1 - 0.5 * t) + Math.max(0, since - GLIDE_S);
  const travel = state.travel + oldRate * since + (newRate - oldRate) * glided_s;
  if (t >= 1 || state.before === state.wind) return { before: to, wind: to, time_s, travel, share: 1 };
  const wind = between(from, to, share);
  if (sameField(from, to)) return { before: wind, wind, time_s, travel, share: 1 };
  const { model, seed, beta, waves } = from;
  return { before: { ...wind, model, seed, beta, waves }, wind, time_s, travel, share };
}

function sameField(a: ResolvedWind, b: ResolvedWind): boolean {
  return fieldKey(a) === fieldKey(b);
}

/** Equal for winds that share the same gust field. */
export function fieldKey(wind: ResolvedWind): string {
  return JSON.stringify([wind.model, wind.seed, wind.beta, wind.waves]);
}

/** Interpolates from a to b, the direction along the shorter arc; model, seed, β and waves are taken from b. */
function between(a: ResolvedWind, b: ResolvedWind, share: number): ResolvedWind {
  const numbers = Object.fromEntries(GLIDING.map((name) => [name, mix(a[name], b[name], share)]));
  const direction = b.direction_deg - (1 - share) * halfTurn(b.direction_deg - a.direction_deg);
  return { ...b, ...numbers, direction_deg: halfTurn(direction) };
}

/** Never outside [a, b], not even by rounding: a wind in transition must be a valid document. */
const mix = (a: number, b: number, share: number): number =>
  Math.min(Math.max(a + share * (b - a), Math.min(a, b)), Math.max(a, b));

/** The same angle in [−180, 180). */
const halfTurn = (angle_deg: number): number =>
  angle_deg + 180 - 360 * Math.floor((angle_deg + 180) / 360) - 180;
