/**
 * State of a forest's wind over time: a change of the document is a smooth transition. The reasons are in
 * precompute/galewood/motion/wind/transition.py.
 */

import { FRONT_LIFE_S, MOST_FRONTS, TRANSITION_S } from "../constants";
import { FIELDS, parseWind, type ResolvedWind, resolveWind, type WindDocument } from "./document";
import { WindError } from "./fields";
import { type Front, parseFronts } from "./fronts";

/** A transition from one wind document to another since a given time; serializable. */
export interface WindState {
  readonly before: WindDocument;
  readonly wind: WindDocument;
  readonly since_s: number;
  /** Distance travelled at `since_s`, in length scales. */
  readonly travel: number;
  /** Gust fronts on their way, the oldest first. */
  readonly fronts?: readonly Front[];
  /** The wind whose transition begins when the present one is over. */
  readonly next?: WindDocument;
}

/** Which gusts within the crowns blow, and how strongly: in a transition the old fade out, then the new in. */
interface CrownFade {
  readonly seed: number;
  readonly length_scale_m: number;
  /** 0 … 1, and 0 for the cosine model. */
  readonly weight: number;
}

/** The wind at one time. `before` and `wind` differ only while one model or seed fades into another. */
export interface Moment {
  readonly before: ResolvedWind;
  readonly wind: ResolvedWind;
  readonly time_s: number;
  readonly travel: number;
  /** Weight of `wind`; the rest is `before`. */
  readonly share: number;
  readonly crown: CrownFade;
}

type Gliding = Exclude<keyof typeof FIELDS, "seed" | "beta" | "direction_deg">;
const TRANSITION_FIELDS = Object.keys(FIELDS).filter(
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
  const next = fields.next === undefined ? {} : { next: parseWind(fields.next) };
  return { ...winds, since_s, travel, ...(fronts.length > 0 && { fronts }), ...next };
}

/** The document that a state ends with when nothing changes any more. */
export const finalWind = (state: WindState): WindDocument => state.next ?? state.wind;

/** Changes to another document: the transition starts now, or after one that must end first. */
export function changeWind(state: WindState, wind: WindDocument, time_s: number): WindState {
  const current = inForce(state, time_s);
  if (progress(current, time_s) < 1 && !sameGusts(current)) return { ...current, next: wind };
  const now = windAt(current, time_s);
  const { fronts } = current;
  return { before: strip(now.wind), wind, since_s: time_s, travel: now.travel, ...(fronts && { fronts }) };
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
  const { waves, recording, ...rest } = wind;
  const fields = FIELDS as Record<string, { models?: readonly string[] }>;
  const own = Object.entries(rest).filter(([name]) => fields[name]?.models?.includes(wind.model) ?? true);
  return {
    ...Object.fromEntries(own),
    ...(wind.model === "cosine" ? { waves } : {}),
    ...(wind.model === "recorded" ? { recording } : {}),
  } as unknown as WindDocument;
}

/** The wind at a time. */
export function windAt(shared: WindState, time_s: number): Moment {
  const state = inForce(shared, time_s);
  const from = resolveWind(state.before);
  const to = resolveWind(state.wind);
  const t = progress(state, time_s);
  const share = t * t * (3 - 2 * t);
  const travel = travelAt(from, to, state, time_s);
  const crown = crownFade(from, to, share);
  const whole = { time_s, travel, share: 1, crown };
  if (t >= 1 || state.before === state.wind) return { before: to, wind: to, ...whole };
  const wind = between(from, to, share);
  if (sameField(from, to)) return { before: wind, wind, ...whole };
  const { model, seed, beta, waves, recording } = from;
  return { before: { ...wind, model, seed, beta, waves, recording }, wind, time_s, travel, share, crown };
}

/** The state itself, or the transition to its next wind when that has begun. */
function inForce(state: WindState, time_s: number): WindState {
  const { before, wind, next, fronts } = state;
  if (!next || progress(state, time_s) < 1) return state;
  const since_s = state.since_s + TRANSITION_S;
  const travel = travelAt(resolveWind(before), resolveWind(wind), state, since_s);
  return { before: wind, wind: next, since_s, travel, ...(fronts && { fronts }) };
}

/** How much of the transition has passed, 0 … 1. */
const progress = (state: WindState, time_s: number): number =>
  Math.min(Math.max((time_s - state.since_s) / TRANSITION_S, 0), 1);

/** Distance travelled at a time, in length scales. */
function travelAt(from: ResolvedWind, to: ResolvedWind, state: WindState, time_s: number): number {
  const t = progress(state, time_s);
  const since = time_s - state.since_s;
  const oldRate = from.convection_speed_m_s / from.length_scale_m;
  const newRate = to.convection_speed_m_s / to.length_scale_m;
  // integral of the smoothstep: t³ − t⁴/2, and ½ at the end
  const transition_s = TRANSITION_S * t * t * t * (1 - 0.5 * t) + Math.max(0, since - TRANSITION_S);
  return state.travel + oldRate * since + (newRate - oldRate) * transition_s;
}

function crownFade(from: ResolvedWind, to: ResolvedWind, share: number): CrownFade {
  const a = crownOf(from);
  const b = crownOf(to);
  if (a.seed === b.seed && a.length_scale_m === b.length_scale_m && a.weight === b.weight) return b;
  if (share < 0.5) return { ...a, weight: (1 - 2 * share) * a.weight };
  return { ...b, weight: (2 * share - 1) * b.weight };
}

/** The gusts within crowns; the cosine model has none. */
const crownOf = ({ seed, length_scale_m, model }: ResolvedWind): CrownFade => ({
  seed,
  length_scale_m,
  weight: model === "cosine" ? 0 : 1,
});

/** Whether the transition only changes numbers that a document of the same model can hold in between. */
function sameGusts({ before, wind }: WindState): boolean {
  const [from, to] = [resolveWind(before), resolveWind(wind)];
  return sameField(from, to) && from.length_scale_m === to.length_scale_m;
}

function sameField(a: ResolvedWind, b: ResolvedWind): boolean {
  return fieldKey(a) === fieldKey(b);
}

/** Equal for winds that share the same gust field. */
export function fieldKey(wind: ResolvedWind): string {
  const { model, seed, beta, waves, recording } = wind;
  const { interval_s, unit, pairs } = recording;
  // not through JSON, which would copy the long text in every frame
  return JSON.stringify([model, seed, beta, waves, interval_s, unit]) + pairs;
}

/** Interpolates from a to b, the direction along the shorter arc; model, seed, β and waves are taken from b. */
function between(a: ResolvedWind, b: ResolvedWind, share: number): ResolvedWind {
  const numbers = Object.fromEntries(TRANSITION_FIELDS.map((name) => [name, mix(a[name], b[name], share)]));
  const direction = b.direction_deg - (1 - share) * halfTurn(b.direction_deg - a.direction_deg);
  return { ...b, ...numbers, direction_deg: halfTurn(direction) };
}

/** Never outside [a, b], not even by rounding: a wind in transition must be a valid document. */
const mix = (a: number, b: number, share: number): number =>
  Math.min(Math.max(a + share * (b - a), Math.min(a, b)), Math.max(a, b));

/** The same angle in [−180, 180). */
const halfTurn = (angle_deg: number): number =>
  angle_deg + 180 - 360 * Math.floor((angle_deg + 180) / 360) - 180;
