/** What the visitor chose: defaults, limits, and the address-bar form of it. Pure. */
import { type Method, parseMethod } from "../../core/motion/method";
import { windDocument } from "../../core/wind/edit";
import { parseWind, type WindDocument, WindError } from "../../core/wind/wind";
import type { Quality } from "../../scene/quality";
import { SEASONS, type Season } from "../../scene/season/season";
import type { LookupPlace } from "../../worker/protocol";

export interface Settings {
  trees: number;
  /** How close trees stand; 1 is the usual. */
  density: number;
  /** How common each species is beside the others, by id; 1 if not named. */
  shares: Record<string, number>;
  /** Seed of the planting. */
  forestSeed: number;
  meanSpeed_m_s: number;
  /** Heading the wind blows towards, see the wind document. */
  direction_deg: number;
  gustiness: number;
  windSeed: number;
  /** Everything else about the wind; null is the plain cosine wind of the four numbers above. */
  wind: WindDocument | null;
  lookup: LookupPlace;
  method: Method;
  /** Share of the way towards the found record's own pose per step; null takes each table's default. */
  poseEasing: number | null;
  quality: Quality;
  season: Season;
  /** Share of the daylight that has passed: 0 before sunrise, 0.5 noon, 1 after sunset. */
  daytime: number;
  /** Leaves tremble in the shader on top of the simulated motion. */
  flutter: boolean;
  panel: boolean;
}

export const LIMITS = {
  trees: { min: 1, max: 10_000, step: 1 },
  density: { min: 0.4, max: 2, step: 0.05 },
  forestSeed: { min: 0, max: 9999, step: 1 },
  meanSpeed_m_s: { min: 0, max: 25, step: 0.1 },
  direction_deg: { min: 0, max: 359, step: 1 },
  gustiness: { min: 0, max: 1, step: 0.01 },
  windSeed: { min: 0, max: 9999, step: 1 },
  poseEasing: { min: 0, max: 0.5, step: 0.005 },
  daytime: { min: 0, max: 1, step: 0.005 },
} as const;

type NumberKey = keyof typeof LIMITS;

export const DEFAULTS: Settings = {
  trees: 400,
  density: 1,
  shares: {},
  forestSeed: 7,
  meanSpeed_m_s: 7,
  direction_deg: 30,
  gustiness: 0.6,
  windSeed: 1,
  wind: null,
  lookup: "worker",
  method: "modal",
  poseEasing: null,
  quality: "high",
  season: "autumn",
  daytime: 0.66,
  flutter: true,
  panel: true,
};

const NAMES: Record<NumberKey, string> = {
  trees: "trees",
  density: "density",
  forestSeed: "forest",
  meanSpeed_m_s: "speed",
  direction_deg: "direction",
  gustiness: "gust",
  windSeed: "seed",
  poseEasing: "easing",
  daytime: "time",
};

const FLAGS = { panel: "panel", flutter: "flutter" } as const;
const numberKeys = Object.keys(LIMITS) as NumberKey[];
const WIND_KEYS: readonly NumberKey[] = ["meanSpeed_m_s", "direction_deg", "gustiness", "windSeed"];

/** Settings with another wind. */
export function withWind<S extends Settings>(settings: S, wind: WindDocument): S {
  settings.wind = wind;
  settings.meanSpeed_m_s = wind.mean_speed_m_s;
  settings.direction_deg = wind.direction_deg - 360 * Math.floor(wind.direction_deg / 360);
  settings.gustiness = wind.gustiness;
  settings.windSeed = wind.seed;
  return settings;
}

/** The wind of an address's `wind` parameter, null without one; throws WindError with the path of what is wrong. */
export function windFromQuery(query: string): WindDocument | null {
  const text = new URLSearchParams(query).get("wind");
  if (text === null) return null;
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    throw new WindError("wind", "expected a JSON object");
  }
  return parseWind(value);
}

function clampTo(key: NumberKey, value: number): number {
  const { min, max, step } = LIMITS[key];
  const clamped = Math.min(max, Math.max(min, value));
  return step === 1 ? Math.round(clamped) : clamped;
}

/** Reads "maple:0.5,poplar:0"; what makes no sense is left out. */
function sharesFrom(text: string): Record<string, number> {
  const shares: Record<string, number> = {};
  for (const part of text.split(",").slice(0, 64)) {
    const [, id, number] = /^([\w-]{1,64}):(\d*\.?\d+)$/.exec(part) ?? [];
    if (id) shares[id] = Math.min(1, Number(number));
  }
  return shares;
}

const textOfShares = (shares: Readonly<Record<string, number>>): string =>
  Object.entries(shares)
    .filter(([, share]) => share !== 1)
    .map(([id, share]) => `${id}:${Number(share.toFixed(2))}`)
    .join(",");

/** Settings from an address such as `?trees=60&speed=12`; what is missing or unreadable keeps its default. */
export function settingsFromQuery(query: string, defaults: Settings = DEFAULTS): Settings {
  const given = new URLSearchParams(query);
  const settings: Settings = { ...defaults, shares: { ...defaults.shares } };
  for (const key of numberKeys) {
    const text = given.get(NAMES[key]);
    const value = Number(text);
    if (text !== null && text.trim() !== "" && Number.isFinite(value)) settings[key] = clampTo(key, value);
  }
  for (const key of Object.keys(FLAGS) as (keyof typeof FLAGS)[]) {
    const text = given.get(FLAGS[key]);
    if (text !== null) settings[key] = text !== "0";
  }
  const lookup = given.get("lookup");
  if (lookup === "worker" || lookup === "server") settings.lookup = lookup;
  const method = parseMethod(given.get("method"));
  if (method) settings.method = method;
  const quality = given.get("quality");
  if (quality === "low" || quality === "medium" || quality === "high") settings.quality = quality;
  const mix = given.get("mix");
  if (mix !== null) settings.shares = sharesFrom(mix);
  const season = SEASONS.find((name) => name === given.get("season"));
  if (season) settings.season = season;
  return settings;
}

/** The shortest query that gives these settings back: only what differs from the defaults. */
export function queryFromSettings(settings: Settings, defaults: Settings = DEFAULTS): string {
  const query = new URLSearchParams();
  for (const key of numberKeys) {
    const value = settings[key];
    if (settings.wind && WIND_KEYS.includes(key)) continue;
    if (value !== null && value !== defaults[key]) query.set(NAMES[key], String(Number(value.toFixed(4))));
  }
  for (const key of Object.keys(FLAGS) as (keyof typeof FLAGS)[]) {
    if (settings[key] !== defaults[key]) query.set(FLAGS[key], settings[key] ? "1" : "0");
  }
  if (settings.lookup !== defaults.lookup) query.set("lookup", settings.lookup);
  if (settings.method !== defaults.method) query.set("method", settings.method);
  if (settings.quality !== defaults.quality) query.set("quality", settings.quality);
  const mix = textOfShares(settings.shares);
  if (mix) query.set("mix", mix);
  if (settings.season !== defaults.season) query.set("season", settings.season);
  if (settings.wind) query.set("wind", JSON.stringify(windDocument(settings)));
  return query.toString();
}

/** Defaults for this screen: fewer trees and pixels on a phone, and where no graphics card draws. */
export function defaultsFor(screen: { width_px: number; touch: boolean; software: boolean }): Settings {
  const phone = screen.width_px < 720;
  if (screen.software) return { ...DEFAULTS, trees: phone ? 60 : 120, quality: "low" };
  return {
    ...DEFAULTS,
    trees: phone ? 160 : DEFAULTS.trees,
    quality: phone || screen.touch ? "medium" : "high",
  };
}
