/**
 * The wind in a URL query. A plain wind is written as four numbers (`speed`, `direction`, `gust`, `seed`), any other
 * wind as a document (`wind`). Pure.
 */
import {
  type PlainWind,
  parseWindText,
  plainWind,
  sameWind,
  type WindDocument,
  withinTurn,
  withPlain,
} from "galewood/wind";
import { clampTo, numberFrom, queryText } from "./queryNumbers";
import { WIND_LIMITS } from "./windLimits";

type PlainKey = keyof PlainWind;

const NAMES: Record<PlainKey, string> = {
  mean_speed_m_s: "speed",
  direction_deg: "direction",
  gustiness: "gust",
  seed: "seed",
};

const KEYS = Object.keys(NAMES) as PlainKey[];

/** The wind in the `wind` parameter; null without one. Throws WindError with the path of the fault. */
export function windFromQuery(query: string): WindDocument | null {
  const text = new URLSearchParams(query).get("wind");
  return text === null ? null : parseWindText(text);
}

/** Applies the plain numbers of a query to a wind. */
export function withQueryNumbers(wind: WindDocument, query: URLSearchParams): WindDocument {
  const given = KEYS.flatMap((key) => {
    const value = numberFrom(query, NAMES[key], WIND_LIMITS[key]);
    return value === null ? [] : [[key, value] as const];
  });
  return given.length === 0 ? wind : withPlain(wind, Object.fromEntries(given));
}

/** Whether the four numbers, as written to a query, restore the wind exactly. */
const isPlain = (wind: WindDocument): boolean =>
  sameWind(wind, plainWind(wind)) &&
  KEYS.every((key) => clampTo(WIND_LIMITS[key], Number(queryText(wind[key]))) === wind[key]);

/** The plain wind that stands for a recording, which is too long for an address. */
function meanOf(wind: WindDocument): WindDocument {
  const { mean_speed_m_s, direction_deg, gustiness, seed } = withinTurn(wind);
  return plainWind({
    mean_speed_m_s: Math.round(10 * mean_speed_m_s) / 10,
    direction_deg: Math.round(direction_deg) % 360,
    gustiness: Math.round(100 * gustiness) / 100,
    seed,
  });
}

/** Writes the difference between a wind and the default wind. */
export function writeWind(query: URLSearchParams, given: WindDocument, usual: WindDocument): void {
  const wind = given.model === "recorded" ? meanOf(given) : withinTurn(given);
  if (sameWind(wind, withinTurn(usual))) return;
  if (!isPlain(wind) || !isPlain(usual)) {
    query.set("wind", JSON.stringify(wind));
    return;
  }
  for (const key of KEYS) if (wind[key] !== usual[key]) query.set(NAMES[key], queryText(wind[key]));
}
