/** Settings in the browser's storage, stored as a query. Unreadable values keep their default. */
import { queryFromSettings, type Settings, settingsFromQuery } from "./settings";
import { windFromQuery } from "./windQuery";

const KEY = "galewood.settings";
const VERSION = 1;

type Store = Pick<Storage, "getItem" | "setItem">;

/** The defaults with the stored settings applied; unreadable storage is ignored. */
export function remembered(defaults: Settings, store: () => Store): Settings {
  try {
    const kept: unknown = JSON.parse(store().getItem(KEY) ?? "null");
    if (typeof kept !== "object" || kept === null) return defaults;
    const { version, query } = kept as Record<string, unknown>;
    if (version !== VERSION || typeof query !== "string") return defaults;
    windFromQuery(query); // throws if the wind is invalid
    return { ...settingsFromQuery(query, defaults), panel: defaults.panel, embed: false };
  } catch {
    return defaults;
  }
}

export function keep(settings: Settings, defaults: Settings, store: () => Store): void {
  try {
    // an inventory belongs to its address
    const query = queryFromSettings({ ...settings, inventory: defaults.inventory }, defaults);
    store().setItem(KEY, JSON.stringify({ version: VERSION, query }));
  } catch {
    // Storage is full or blocked: continue without it.
  }
}
