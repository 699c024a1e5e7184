/** State that a shared link restores besides the settings: camera, clock and clouds. Pure. */
import { DEFAULTS, queryFromSettings, type Settings } from "./settings";

type Triple = readonly [number, number, number];

export interface Moment {
  /** Camera position and target, m. */
  readonly eye: Triple;
  readonly target: Triple;
  /** Time of the forest, which determines the gusts. */
  readonly time_s: number;
  /** Drift of the clouds. */
  readonly clouds: readonly [number, number];
}

const FARTHEST_M = 5000;
const LONGEST_S = 1e7;

const text = (list: readonly number[], digits: number) =>
  list.map((number) => Number(number.toFixed(digits))).join(",");

/** Parses a list of numbers; null unless it has `count` numbers within the limit. */
function numbers(list: string | null, count: number, limit: number): number[] | null {
  const found = (list ?? "").split(",").map((part) => (part.trim() === "" ? Number.NaN : Number(part)));
  return found.length === count && found.every((n) => Math.abs(n) <= limit) ? found : null;
}

/** A query that shows the same picture in another browser. */
export function shareQuery(settings: Settings, moment: Moment): string {
  // Always include the number of trees, because its default depends on the screen; quality, frame rate and workers are the receiver's.
  const { quality, frameRateLimit_hz, workers } = settings;
  const usual = { ...DEFAULTS, trees: Number.NaN, quality, frameRateLimit_hz, workers };
  const query = new URLSearchParams(queryFromSettings(settings, usual));
  query.set("view", text([...moment.eye, ...moment.target], 2));
  query.set("at", text([moment.time_s], 2));
  query.set("clouds", text(moment.clouds, 4));
  return query.toString();
}

/** Parses the state from a query; missing or invalid parts are null. */
export function momentFrom(query: string): { [K in keyof Moment]: Moment[K] | null } {
  const given = new URLSearchParams(query);
  const view = numbers(given.get("view"), 6, FARTHEST_M);
  const clock = numbers(given.get("at"), 1, LONGEST_S);
  const clouds = numbers(given.get("clouds"), 2, 1e5);
  return {
    eye: view ? [view[0], view[1], view[2]] : null,
    target: view ? [view[3], view[4], view[5]] : null,
    time_s: clock ? Math.max(0, clock[0]) : null,
    clouds: clouds ? [clouds[0], clouds[1]] : null,
  };
}
