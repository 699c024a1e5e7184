/** What follows from a change of the settings, whoever makes it. */
import type { About } from "galewood/client";
import { parseWind, type WindDocument } from "galewood/wind";
import { exaggeration } from "../scene/exaggeration";
import type { Forest } from "../scene/forest";
import type { Season } from "../scene/season/season";
import type { Stage } from "../scene/stage";
import type { ForestClient } from "./forestClient";
import type { InventoryPlanting } from "./inventory/inventoryPlanting";
import type { PaperMethod } from "./paper/paperMethod";
import type { Planting } from "./planting";
import type { Catalogue } from "./server/catalogue";
import { queryFromSettings, type Settings } from "./settings/settings";
import { adoptPlacement, withShared } from "./settings/sharedForest";
import { keep } from "./settings/storedSettings";
import { speciesOptions } from "./speciesOptions";
import { showExaggeration } from "./ui/exaggerated";
import type { Panel, SettingKey } from "./ui/panel";
import type { SceneryBar } from "./ui/scenery";
import type { Visit } from "./visit";
import type { WindStudio } from "./windStudio";

const PLACEMENT_KEYS: SettingKey[] = [
  "trees",
  "density",
  "shares",
  "planted",
  "form",
  "inventory",
  "forestSeed",
  "lookup",
  "method",
  "poseEasing",
];

/** The parts of the page that depend on settings. */
export interface ChangingParts {
  readonly settings: Settings;
  /** Settings are stored as differences from these. */
  readonly defaults: Settings;
  readonly stage: Stage;
  readonly forest: Forest;
  readonly client: ForestClient;
  readonly catalogue: Catalogue;
  readonly planting: Planting;
  readonly paper: PaperMethod;
  readonly inventory: InventoryPlanting;
  readonly panel: Panel;
  readonly scenery: SceneryBar;
  readonly studio: WindStudio;
  readonly visit: Visit;
  readonly flutter: { value: { x: number; y: number } };
  /** Whether the trees to draw must be selected again. */
  readonly view: { changed: boolean };
}

export class Changes {
  constructor(private readonly page: ChangingParts) {}

  /** Applies a setting that has changed, and stores it. */
  apply(key: SettingKey): void {
    const { settings, stage, forest, catalogue, planting, paper, inventory, flutter } = this.page;
    if (key === "season") this.applyScenery();
    if (key === "season" || key === "lookup") catalogue.bare = this.playsBareTables;
    if (key === "wind") {
      this.changeWind(settings.wind, "panel");
      return;
    }
    if (key === "planted") catalogue.choose();
    if (key === "inventory") inventory.follow();
    if (PLACEMENT_KEYS.includes(key)) planting.place(key !== "lookup");
    if (key === "method" || key === "lookup") paper.chosen();
    if (key === "quality") {
      stage.setQuality(settings.quality);
      forest.options = speciesOptions(settings.quality, stage, flutter);
      planting.place();
    }
    if (key === "background") {
      stage.backdrop.shown = settings.background;
      planting.place();
    }
    if (key === "exaggeration") this.exaggerate();
    this.remember(key);
  }

  /** Settings were replaced by undo or redo. */
  replaced(keys: readonly SettingKey[]): void {
    this.page.panel.showReplaced();
    this.page.scenery.show();
    for (const key of keys) {
      if (key === "wind") this.changeWind(this.page.settings.wind, "instruments");
      else this.apply(key);
    }
  }

  /** Sets the wind from an untrusted document; throws WindError if it is invalid. */
  setWind(document: unknown): void {
    this.changeWind(parseWind(document), "instruments");
  }

  /** The only place that changes the page's wind; the worker already knows a shared one. */
  changeWind(wind: WindDocument, origin: "panel" | "instruments" | "shared"): void {
    const { settings, panel, client, studio, visit } = this.page;
    settings.wind = wind;
    if (origin !== "panel") panel.refresh();
    if (origin !== "shared") client.setWind(wind);
    studio.showWind();
    if (origin === "shared") visit.undo.adopt();
    this.remember("wind");
  }

  /** Called when another client replaced the trees of this shared forest. */
  takePlacement(about: About): void {
    const { settings, panel, catalogue, planting, inventory, paper, visit } = this.page;
    const before = settings.inventory;
    if (!adoptPlacement(settings, about)) return;
    panel.refresh();
    catalogue.choose();
    if (settings.inventory === before) planting.place();
    else inventory.follow();
    paper.chosen();
    visit.undo.adopt();
    this.remember("placement");
  }

  /** The forest of this page becomes a shared one: its trees, its wind and its time. Returns whether it can. */
  startSharing(id: string): boolean {
    const { planting, catalogue, inventory } = this.page;
    if (!inventory.canBeShared()) return false;
    planting.share = id;
    catalogue.bare = this.playsBareTables;
    planting.place(true);
    this.remember("share");
    return true;
  }

  /** Sets season and time of day. */
  setScenery(season: Season, daytime: number): void {
    const { settings, scenery } = this.page;
    settings.season = season;
    settings.daytime = Math.min(1, Math.max(0, daytime));
    scenery.show();
    this.apply("season");
  }

  /** Applies season and time of day to light, land and leaves. */
  applyScenery(): void {
    const { settings, stage, forest, view } = this.page;
    stage.show(settings.daytime, settings.season);
    forest.setSeason(settings.season);
    stage.shelter(forest.crowns);
    view.changed = true;
  }

  /** The server moves a shared forest by the tables in leaf, because its clients may look at it in any season. */
  get playsBareTables(): boolean {
    const { season, lookup } = this.page.settings;
    return season === "winter" && (this.page.planting.share === null || lookup === "worker");
  }

  /** Sets the factor of all displacements on screen; figures stay as simulated. */
  exaggerate(): void {
    const factor = this.page.settings.exaggeration;
    exaggeration.value = factor;
    showExaggeration(factor);
    this.page.view.changed = true;
  }

  /** Stores the settings and updates the URL; `kind` names what was changed. */
  remember(kind: string): void {
    const { settings, defaults, planting, visit } = this.page;
    visit.undo.record(kind);
    // The placement of a shared forest is not that of this visitor.
    if (settings.panel && planting.share === null) keep(settings, defaults, () => localStorage);
    const query = withShared(queryFromSettings(settings), planting.share);
    history.replaceState(null, "", query ? `?${query}` : location.pathname);
  }
}
