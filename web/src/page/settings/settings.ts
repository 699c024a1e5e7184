/** Settings of the visitor: defaults, limits and conversion from and to the URL query. Pure. */

import type { LookupPlace } from "galewood/client";
import { type Method, parseMethod } from "galewood/motion";
import type { WindDocument } from "galewood/wind";
import { plainWind } from "galewood/wind";
import { FORM_CHOICES, type FormChoice } from "../../scene/forms";
import { MOST_OWN_TREES } from "../../scene/individuals";
import type { Quality } from "../../scene/quality";
import { SEASONS, type Season } from "../../scene/season/season";
import { DAYTIMES } from "../../scene/sky/daytime";
import { type PlantedTrees, plantedFrom, textOfPlanted } from "./planted";
import { numberFrom, queryText } from "./queryNumbers";
import { windFromQuery, withQueryNumbers, writeWind } from "./windQuery";

export interface Settings {
  trees: number;
  /** Density of the trees relative to the default. */
  density: number;
  /** Relative frequency of each species by id; 1 if omitted. */
  shares: Readonly<Record<string, number>>;
  /** Uploaded trees of this forest, and how they are planted. */
  planted: PlantedTrees;
  /** Form of the built-in species: the one that suits each place, or the same everywhere. */
  form: FormChoice;
  /** Number of trees that the server grows for this forest; 0: the built-in ones stand for all. */
  ownTrees: number;
  /** Address of the inventory whose stems are planted; empty: the forest is invented. */
  inventory: string;
  /** Seed of the placement. */
  forestSeed: number;
  /** The only copy of the page's wind: panel, instruments, links and worker read it here. */
  wind: WindDocument;
  lookup: LookupPlace;
  method: Method;
  /** Fraction of the distance to the found record's pose covered per step; null: the default of each table. */
  poseEasing: number | null;
  /** Number of workers that divide the trees; null: by their number and the processor's cores. */
  workers: number | null;
  quality: Quality;
  /** Pictures per second at most; the motion keeps its speed. */
  frameRateLimit_hz: number;
  season: Season;
  /** Elapsed share of the daylight: 0 before sunrise, 0.5 at noon, 1 after sunset; night beyond (DAYTIMES). */
  daytime: number;
  /** Factor of all displacements on screen; above 1 the motion is exaggerated. */
  exaggeration: number;
  /** Whether a forest continues beyond the simulated trees, and distant ones are drawn from pictures. */
  background: boolean;
  /** Leaf flutter, added by the shader to the simulated motion. */
  flutter: boolean;
  panel: boolean;
  /** Embedded in another page: no controls but pause and a link. */
  embed: boolean;
}

export const LIMITS = {
  trees: { min: 1, max: 100_000, step: 1 },
  density: { min: 0.4, max: 2, step: 0.05 },
  forestSeed: { min: 0, max: 9999, step: 1 },
  ownTrees: { min: 0, max: MOST_OWN_TREES, step: 1 },
  poseEasing: { min: 0, max: 0.5, step: 0.005 },
  workers: { min: 1, max: 8, step: 1 },
  daytime: DAYTIMES,
  exaggeration: { min: 1, max: 4, step: 0.1 },
  frameRateLimit_hz: { min: 5, max: 240, step: 1 },
} as const;

const LONGEST_ADDRESS = 500;

type NumberKey = keyof typeof LIMITS;

/** Built-in species that are not planted unless the visitor wants them: the mix has five, whose meshes are loaded at the start. */
const LEFT_OUT = ["apricot", "oak", "ash", "sycamore", "willow", "pine", "larch"];

export const DEFAULTS: Settings = {
  trees: 400,
  density: 1,
  shares: Object.fromEntries(LEFT_OUT.map((id) => [id, 0])),
  planted: {},
  form: "place",
  ownTrees: 0,
  inventory: "",
  forestSeed: 7,
  wind: plainWind({ mean_speed_m_s: 8, direction_deg: 30, gustiness: 0.7, seed: 1 }),
  lookup: "worker",
  method: "modal",
  poseEasing: null,
  workers: null,
  quality: "high",
  frameRateLimit_hz: 240,
  season: "autumn",
  daytime: 0.66,
  exaggeration: 1,
  background: true,
  flutter: true,
  panel: true,
  embed: false,
};

const NAMES: Record<NumberKey, string> = {
  trees: "trees",
  density: "density",
  forestSeed: "forest",
  ownTrees: "own",
  poseEasing: "easing",
  workers: "workers",
  daytime: "time",
  exaggeration: "motion",
  frameRateLimit_hz: "fps",
};

const FLAGS = { panel: "panel", background: "background", flutter: "flutter", embed: "embed" } as const;
const numberKeys = Object.keys(LIMITS) as NumberKey[];
/** Parses what differs from the usual shares, such as "maple:0.5,poplar:0"; invalid parts are ignored. */
function sharesFrom(text: string, usual: Settings["shares"]): Record<string, number> {
  const shares: Record<string, number> = { ...usual };
  for (const part of text.split(",").slice(0, 64)) {
    const [, id, number] = /^([\w-]{1,64}):(\d*\.?\d+)$/.exec(part) ?? [];
    if (id) shares[id] = Math.min(1, Number(number));
  }
  return Object.fromEntries(Object.entries(shares).filter(([, share]) => share !== 1));
}

const textOfShares = (shares: Settings["shares"], usual: Settings["shares"]): string =>
  Object.keys({ ...usual, ...shares })
    .map((id) => [id, shares[id] ?? 1] as const)
    .filter(([id, share]) => share !== (usual[id] ?? 1))
    .map(([id, share]) => `${id}:${Number(share.toFixed(2))}`)
    .join(",");

function usableWind(query: string): WindDocument | null {
  try {
    return windFromQuery(query);
  } catch {
    return null; // reported by the page at start
  }
}

/** Settings from a query such as `?trees=60&speed=12`; missing or invalid values keep their default. */
export function settingsFromQuery(query: string, defaults: Settings = DEFAULTS): Settings {
  const given = new URLSearchParams(query);
  const settings: Settings = { ...defaults, shares: { ...defaults.shares } };
  settings.wind = usableWind(query) ?? withQueryNumbers(defaults.wind, given);
  for (const key of numberKeys) {
    const value = numberFrom(given, NAMES[key], LIMITS[key]);
    if (value !== null) settings[key] = value;
  }
  for (const key of Object.keys(FLAGS) as (keyof typeof FLAGS)[]) {
    const text = given.get(FLAGS[key]);
    if (text !== null) settings[key] = text !== "0";
  }
  if (settings.embed) settings.panel = false;
  const lookup = given.get("lookup");
  if (lookup === "worker" || lookup === "server") settings.lookup = lookup;
  const method = parseMethod(given.get("method"));
  if (method) settings.method = method;
  const quality = given.get("quality");
  if (quality === "low" || quality === "medium" || quality === "high") settings.quality = quality;
  const mix = given.get("mix");
  if (mix !== null) settings.shares = sharesFrom(mix, defaults.shares);
  const planted = given.get("tree");
  if (planted !== null) settings.planted = plantedFrom(planted);
  const form = FORM_CHOICES.find((name) => name === given.get("form"));
  if (form) settings.form = form;
  const inventory = given.get("inventory");
  if (inventory !== null) settings.inventory = inventory.slice(0, LONGEST_ADDRESS);
  const season = SEASONS.find((name) => name === given.get("season"));
  if (season) settings.season = season;
  return settings;
}

/** The number of trees that a query asks for beyond what the page can plant; null if it does not. */
export function treesBeyond(query: string): number | null {
  const asked = Number(new URLSearchParams(query).get("trees"));
  return asked > LIMITS.trees.max ? asked : null;
}

/** The shortest query that restores these settings: only the differences from the defaults. */
export function queryFromSettings(settings: Settings, defaults: Settings = DEFAULTS): string {
  const query = new URLSearchParams();
  for (const key of numberKeys) {
    const value = settings[key];
    if (value !== null && value !== defaults[key]) query.set(NAMES[key], queryText(value));
  }
  for (const key of Object.keys(FLAGS) as (keyof typeof FLAGS)[]) {
    if (settings[key] !== defaults[key]) query.set(FLAGS[key], settings[key] ? "1" : "0");
  }
  if (settings.lookup !== defaults.lookup) query.set("lookup", settings.lookup);
  if (settings.method !== defaults.method) query.set("method", settings.method);
  if (settings.quality !== defaults.quality) query.set("quality", settings.quality);
  const mix = textOfShares(settings.shares, defaults.shares);
  if (mix) query.set("mix", mix);
  const planted = textOfPlanted(settings.planted);
  if (planted !== textOfPlanted(defaults.planted)) query.set("tree", planted);
  if (settings.form !== defaults.form) query.set("form", settings.form);
  if (settings.inventory !== defaults.inventory) query.set("inventory", settings.inventory);
  if (settings.season !== defaults.season) query.set("season", settings.season);
  writeWind(query, settings.wind, defaults.wind);
  return query.toString();
}

/** Defaults for this screen: fewer trees and lower quality on phones and with software rendering. */
export function defaultsFor(screen: { width_px: number; touch: boolean; software: boolean }): Settings {
  const phone = screen.width_px < 720;
  if (screen.software) return { ...DEFAULTS, trees: phone ? 60 : 120, quality: "low" };
  return {
    ...DEFAULTS,
    trees: phone ? 160 : DEFAULTS.trees,
    quality: phone || screen.touch ? "medium" : "high",
  };
}
