/** A shared forest: its id in the address, and the description of its placement that clients exchange. Pure. */

import type { About } from "galewood/client";
import { queryFromSettings, type Settings, settingsFromQuery } from "./settings";

/** The settings that determine the placement. */
export const PLACEMENT_KEYS = [
  "trees",
  "density",
  "shares",
  "planted",
  "form",
  "ownTrees",
  "inventory",
  "forestSeed",
  "method",
  "poseEasing",
] as const;

/** The id of an address's `share` parameter; null without a valid one. */
export function sharedFrom(query: string): string | null {
  const id = new URLSearchParams(query).get("share");
  return id !== null && /^[A-Za-z0-9_-]{1,64}$/.test(id) ? id : null;
}

/** A query with the shared forest's id. */
export function withShared(query: string, share: string | null): string {
  const all = new URLSearchParams(query);
  if (share !== null) all.set("share", share);
  return all.toString();
}

/** What others need to reproduce the placement. */
export function placementOf(settings: Settings): About {
  const standard = settingsFromQuery("");
  const placed = Object.fromEntries(PLACEMENT_KEYS.map((key) => [key, standard[key]]));
  const usual: Settings = { ...settings, ...placed, trees: Number.NaN, forestSeed: Number.NaN };
  const query = queryFromSettings(settings, usual);
  return query.length <= 200 ? { planting: query } : {};
}

/** What differs in the placement of another client; empty if nothing does, or if it says nothing. */
export function foreignPlacement(settings: Settings, { planting }: About): Partial<Settings> {
  if (typeof planting !== "string") return {};
  const given = settingsFromQuery(planting);
  const keys = PLACEMENT_KEYS.filter((key) => JSON.stringify(given[key]) !== JSON.stringify(settings[key]));
  return Object.fromEntries(keys.map((key) => [key, given[key]]));
}
