/** Settings from one visit to the next. Whatever is kept there is taken as a query: what is odd keeps its default. */
import { queryFromSettings, type Settings, settingsFromQuery, windFromQuery, withWind } from "./settings";

const KEY = "galewood.settings";
const VERSION = 1;

type Shelf = Pick<Storage, "getItem" | "setItem">;

/** The defaults, changed by what was kept; a browser that keeps nothing, or rubbish, changes nothing. */
export function remembered(defaults: Settings, shelf: () => Shelf): Settings {
  try {
    const kept: unknown = JSON.parse(shelf().getItem(KEY) ?? "null");
    if (typeof kept !== "object" || kept === null) return defaults;
    const { version, query } = kept as Record<string, unknown>;
    if (version !== VERSION || typeof query !== "string") return defaults;
    const settings = settingsFromQuery(query, defaults);
    const wind = windFromQuery(query);
    if (wind) withWind(settings, wind);
    return { ...settings, panel: defaults.panel };
  } catch {
    return defaults;
  }
}

export function keep(settings: Settings, defaults: Settings, shelf: () => Shelf): void {
  try {
    shelf().setItem(KEY, JSON.stringify({ version: VERSION, query: queryFromSettings(settings, defaults) }));
  } catch {
    // A full or forbidden storage: the page works without.
  }
}
