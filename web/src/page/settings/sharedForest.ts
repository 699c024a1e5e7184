/** A forest that many share, as the address names it and as its planters describe it to each other. Pure. */

import type { About } from "../../core/wire/wire";
import { queryFromSettings, type Settings, settingsFromQuery } from "./settings";

/** What decides where which trees stand. */
const PLACEMENT_KEYS = ["trees", "density", "shares", "forestSeed", "method", "poseEasing"] as const;

/** The id of an address's `share` parameter; null without one that servers take. */
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

/** What others need to plant the same trees. */
export function placementOf(settings: Settings): About {
  const usual: Settings = { ...settings, trees: Number.NaN, forestSeed: Number.NaN };
  for (const key of ["density", "shares", "method", "poseEasing"] as const) {
    Object.assign(usual, { [key]: settingsFromQuery("")[key] });
  }
  const query = queryFromSettings(settings, usual);
  return query.length <= 200 ? { planting: query } : {};
}

/** Takes over what another planted; whether that differs from what is here. */
export function adoptPlacement(settings: Settings, about: About): boolean {
  if (typeof about.planting !== "string") return false;
  const given = settingsFromQuery(about.planting);
  const before = JSON.stringify(PLACEMENT_KEYS.map((key) => settings[key]));
  for (const key of PLACEMENT_KEYS) Object.assign(settings, { [key]: given[key] });
  return JSON.stringify(PLACEMENT_KEYS.map((key) => settings[key])) !== before;
}
