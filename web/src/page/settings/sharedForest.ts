/** A shared forest: its id in the address, and the description of its placement that clients exchange. Pure. */

import type { About } from "galewood/client";
import { queryFromSettings, type Settings, settingsFromQuery } from "./settings";

/** The settings that determine the placement. */
const PLACEMENT_KEYS = [
  "trees",
  "density",
  "shares",
  "planted",
  "form",
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
  const usual: Settings = { ...settings, trees: Number.NaN, forestSeed: Number.NaN };
  for (const key of ["density", "shares", "planted", "form", "inventory", "method", "poseEasing"] as const) {
    Object.assign(usual, { [key]: settingsFromQuery("")[key] });
  }
  const query = queryFromSettings(settings, usual);
  return query.length <= 200 ? { planting: query } : {};
}

/** Adopts the placement of another client; returns whether it differs. */
export function adoptPlacement(settings: Settings, about: About): boolean {
  if (typeof about.planting !== "string") return false;
  const given = settingsFromQuery(about.planting);
  const before = JSON.stringify(PLACEMENT_KEYS.map((key) => settings[key]));
  for (const key of PLACEMENT_KEYS) Object.assign(settings, { [key]: given[key] });
  return JSON.stringify(PLACEMENT_KEYS.map((key) => settings[key])) !== before;
}
