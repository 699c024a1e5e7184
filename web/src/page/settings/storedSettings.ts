/**
 * Settings in the address, and in the browser's storage for the next visit, where they are stored as a query. Unreadable
 * values keep their default.
 */
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { queryFromSettings, type Settings, settingsFromQuery } from "./settings";
import { withShared } from "./sharedForest";
import { windFromQuery } from "./windQuery";

const STORAGE_KEY = "galewood.settings";
const VERSION = 1;

type Shelf = Pick<Storage, "getItem" | "setItem">;

/** The defaults with the stored settings applied; unreadable storage is ignored. */
export function remembered(defaults: Settings, shelf: () => Shelf): Settings {
  try {
    const kept: unknown = JSON.parse(shelf().getItem(STORAGE_KEY) ?? "null");
    if (typeof kept !== "object" || kept === null) return defaults;
    const { version, query } = kept as Record<string, unknown>;
    if (version !== VERSION || typeof query !== "string") return defaults;
    windFromQuery(query); // throws if the wind is invalid
    return { ...settingsFromQuery(query, defaults), panel: defaults.panel, embed: false };
  } catch {
    return defaults;
  }
}

export function keep(settings: Settings, defaults: Settings, shelf: () => Shelf): void {
  try {
    const query = queryFromSettings(settings, defaults);
    shelf().setItem(STORAGE_KEY, JSON.stringify({ version: VERSION, query }));
  } catch {
    // Storage is full or blocked: continue without it.
  }
}

/**
 * What is kept for the next visit: an inventory belongs to its address, and the trees grown for its stems to it; so does a number of
 * workers, which no control shows.
 */
export function keptOf({ settings, defaults, state }: Store): Settings {
  const { inventory, ownTrees, workers } = defaults;
  return { ...settings, inventory, workers, ...(state.inventory !== null && { ownTrees }) };
}

/** Keeps address and storage up to date from now on. */
export function rememberSettings(store: Store): void {
  const { settings, defaults, state } = store;
  const remember = () => {
    // The placement of a shared forest is not that of this visitor.
    if (settings.panel && state.share === null) keep(keptOf(store), defaults, () => localStorage);
    const query = withShared(queryFromSettings(settings), state.share);
    history.replaceState(null, "", query ? `?${query}` : location.pathname);
  };
  store.onChange(remember);
  watch(() => [state.share], remember);
}
