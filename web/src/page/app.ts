/** The application: connects stage, forest, worker, catalogue and panel. */

import type { About } from "galewood/client";
import type { SpeciesOptions } from "galewood/trees";
import { LEVEL_SHARES, PullSlots } from "galewood/trees";
import { parseWind, sameWind, type WindDocument } from "galewood/wind";
import { exaggeration } from "../scene/exaggeration";
import { Forest } from "../scene/forest";
import { groundHeight_m } from "../scene/ground/landscape";
import type { Season } from "../scene/season/season";
import { seasonal } from "../scene/season/seasonal";
import { aerialPerspective } from "../scene/sky/air";
import { cascadeReach_m } from "../scene/sky/daylight";
import { Stage } from "../scene/stage";
import { standView } from "../scene/stand";
import { materialsOf } from "../scene/treeSurface/treeMaterial";
import { Attention } from "./attention";
import { Comparison } from "./compare/comparison";
import { ContextLoss } from "./contextLoss";
import type { DataFiles } from "./files/dataFiles";
import { ForestClient } from "./forestClient";
import { ForestFigures } from "./forestFigures";
import { FrameLoop } from "./frameLoop";
import { FrameStatistics } from "./frameStatistics";
import { InventoryForest } from "./inventory/inventoryForest";
import { TreeOverlays } from "./overlays/treeOverlays";
import { OwnTrees } from "./ownTree/ownTrees";
import type { OwnUploads } from "./ownTree/ownUploads";
import { PaperMethod } from "./paper/paperMethod";
import { Planting } from "./planting";
import { Playback } from "./playback";
import { Gusts } from "./pulling/gusts";
import { Puller } from "./pulling/puller";
import { cancelJob, Problem, type TreeChange, useKeys } from "./server/api";
import { Catalogue } from "./server/catalogue";
import { momentFrom } from "./settings/link";
import { plantedAs } from "./settings/planted";
import { queryFromSettings, type Settings } from "./settings/settings";
import { adoptPlacement, sharedFrom, withShared } from "./settings/sharedForest";
import { keep } from "./settings/storedSettings";
import { WindSound } from "./sound";
import { StatusReport } from "./statusReport";
import { TreePicker } from "./treePicker";
import { element } from "./ui/dom";
import { showExaggeration } from "./ui/exaggerated";
import { InventoryCard } from "./ui/inventoryCard";
import { askForKey, keptKey } from "./ui/keyDialog";
import { Panel, type SettingKey } from "./ui/panel";
import { PickedCard } from "./ui/pickedCard";
import { ProgressCards } from "./ui/progress";
import { SceneryBar } from "./ui/scenery";
import { showToast } from "./ui/toast";
import { Visit } from "./visit";
import { WindStudio } from "./windStudio";

const NOT_SHARED =
  "Put it at an address of this server (galewood forest FILE) and open the page with ?inventory=ADDRESS.";
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

export class App {
  readonly stage: Stage;
  private readonly client = new ForestClient(showToast, {
    placement: (about) => this.takePlacement(about),
    present: (clients) => this.visit.sharing.present(clients),
    wind: (wind) => {
      if (!sameWind(wind, this.settings.wind)) this.changeWind(wind, "shared");
    },
  });
  private readonly catalogue: Catalogue;
  private readonly paper: PaperMethod;
  private readonly forest: Forest;
  private readonly planting: Planting;
  private readonly inventory: InventoryForest;
  private readonly inventoryCard: InventoryCard;
  private readonly comparison: Comparison;
  readonly figures: ForestFigures;
  private readonly cards: ProgressCards;
  private readonly ownTrees: OwnTrees;
  private readonly panel: Panel;
  readonly studio: WindStudio;
  readonly overlays: TreeOverlays;
  readonly visit: Visit;
  private readonly scenery: SceneryBar;
  readonly picker: TreePicker;
  readonly puller: Puller;
  private readonly gusts: Gusts;
  private readonly pickedCard: PickedCard;
  readonly playback = new Playback();
  readonly sound = new WindSound();
  private readonly graphics: ContextLoss;
  private readonly meter = new FrameStatistics();
  private readonly attention = new Attention({
    hide: (hidden) => {
      this.client.hide(hidden);
      this.sound.hide(hidden);
    },
    retry: () => this.reconnect(),
  });
  private readonly status: StatusReport;
  private readonly flutter = { value: { x: 0, y: 0 } };
  private readonly exaggeration = exaggeration;
  /** Whether the trees to draw must be selected again. */
  private readonly view = { changed: true };
  private connected = true;
  readonly loop: FrameLoop;

  /** Settings are stored as differences from `defaults`. */
  constructor(
    readonly settings: Settings,
    private readonly defaults: Settings,
    uploads: OwnUploads,
    files: DataFiles,
  ) {
    useKeys({ known: keptKey, ask: askForKey });
    this.stage = new Stage(element<HTMLCanvasElement>("view"), settings.quality);
    // three.js creates its own resources again when it draws; what depends on the view is selected again.
    this.graphics = new ContextLoss(this.stage.renderer.domElement, () => this.applyScenery());
    this.stage.backdrop.shown = settings.background;
    this.forest = new Forest(this.speciesOptions(), this.stage.backdrop.library);
    this.stage.scene.add(this.forest.group);
    this.applyScenery();
    this.exaggerate();
    this.scenery = new SceneryBar(settings, () => this.change("season"));
    this.visit = new Visit(
      settings,
      this.stage,
      this.forest,
      () => this.catalogue,
      () => this.client.time_s,
      () => void this.comparison.open(),
      this.playback,
      this.sound,
      {
        replaced: (keys) => this.showReplaced(keys),
        share: () => this.planting?.share ?? sharedFrom(location.search),
        startSharing: (id) => this.startSharing(id),
      },
    );
    this.visit.restore(location.search);
    this.panel = new Panel(
      settings,
      this.meter.statistics,
      this.playback,
      this.sound,
      (key) => this.change(key),
      (id, how) => this.ownTrees.plant(id, how),
    );
    this.inventory = new InventoryForest({ changed: () => this.inventoryChanged(), problem: showToast });
    this.inventoryCard = new InventoryCard({
      report: () => this.inventory.report(),
      look: () => this.showStand(),
      remove: () => this.followInventory(""),
    });
    this.catalogue = new Catalogue((sha256) => this.client.loadTable(sha256), {
      isPlanted: (id) => plantedAs(settings, id) !== null || this.isInInventory(id),
      change: (change) => this.treeChanged(change),
      assetsChanged: () => {
        this.planting.place();
        this.paper.update();
      },
      recordsChanged: () => this.takeRecords(),
      connected: (connected) => {
        this.connected = connected;
      },
      problem: showToast,
    });
    this.planting = new Planting(
      settings,
      this.stage,
      this.forest,
      this.client,
      this.catalogue,
      () => {
        this.view.changed = true;
        this.ownTrees.appeared();
      },
      this.inventory,
    );
    this.ownTrees = new OwnTrees(uploads, {
      settings,
      stage: this.stage,
      forest: this.forest,
      catalogue: this.catalogue,
      visit: this.visit,
      isShared: () => this.planting.share !== null,
      replant: () => this.change("planted"),
      planted: (id) => this.cards.planted(id),
    });
    this.cards = new ProgressCards(this.ownTrees);
    this.catalogue.bare = this.playsBareTables;
    this.paper = new PaperMethod(settings, {
      trees: () => this.catalogue.known,
      load: (table, records) => this.client.loadRecords(table, records),
      arrived: () => this.planting.place(),
      problem: showToast,
    });
    this.studio = new WindStudio(this.stage, settings, {
      wind: (wind) => this.changeWind(wind, "instruments"),
      problem: showToast,
    });
    this.picker = new TreePicker(this.stage, this.forest, this.client, () => this.showPicked());
    this.picker.enabled = () => !this.studio.isPlacing;
    const moves = () => !this.loop.paused && !this.playback.paused;
    this.puller = new Puller(this.stage, this.forest, this.client, this.picker, moves);
    this.gusts = new Gusts(this.stage, this.client);
    this.picker.onGround = (x_m, z_m) => this.gusts.send(x_m, z_m);
    this.overlays = new TreeOverlays(this.stage, this.forest, this.client, {
      picked: () => {
        const { figures, moving } = this.picker;
        return figures && { treeId: figures.treeId, at: moving };
      },
      find: (treeId) => this.catalogue.find(treeId),
      error: (sha256) => this.comparison.errors.get(sha256) ?? null,
      field: this.studio.field,
      exaggeration: this.exaggeration,
    });
    this.pickedCard = new PickedCard(
      {
        follow: (following) => {
          this.picker.following = following;
        },
        compare: () => void this.comparison.open(),
        physics: () => this.visit.openPhysics(),
        cancel: (jobId) => void this.cancel(jobId),
        planted: (id) => plantedAs(settings, id),
        plant: (id, how) => this.ownTrees.plant(id, how),
        close: () => this.picker.select(null),
      },
      this.overlays.menu.element,
    );
    const { stage, forest, client, catalogue, paper, meter, picker } = this;
    this.comparison = new Comparison(forest, client, catalogue, picker, (busy) => {
      // The forest stops meanwhile, to leave the processor to the comparison.
      this.loop.asleep = busy;
    });
    this.status = new StatusReport(settings, stage, forest, client, meter, () => this.reconnect());
    this.figures = new ForestFigures(forest, client, catalogue, paper, meter);
    if (settings.inventory !== "") void this.inventory.follow(settings.inventory);
    files.connect({
      inventory: (file) => void this.openInventory(file),
      measurement: (file) => void this.studio.loadMeasurement(file),
      wind: (file) => void this.studio.loadWind(file),
    });
    this.loop = new FrameLoop({
      settings,
      stage,
      forest,
      client,
      picker,
      meter,
      view: this.view,
      planting: this.planting,
      visit: this.visit,
      playback: this.playback,
      ownTrees: this.ownTrees,
      puller: this.puller,
      gusts: this.gusts,
      studio: this.studio,
      overlays: this.overlays,
      sound: this.sound,
      flutter: this.flutter,
      isUnseen: () => this.attention.hidden || this.graphics.lost,
      report: () => this.report(),
    });
    this.loop.start();
  }

  private speciesOptions(): SpeciesOptions {
    const { quality } = this.settings;
    const { capabilities } = this.stage.renderer;
    return {
      materials: materialsOf({
        anisotropy: quality === "low" ? 1 : Math.min(4, capabilities.getMaxAnisotropy()),
        smoothEdges: quality !== "low",
        gloss: quality === "high",
        surface: seasonal,
        atmosphere: aerialPerspective,
      }),
      maxTextureSide: Math.min(capabilities.maxTextureSize, 4096),
      // If gloss is affordable, so are the shadows of all leaves.
      shadows: { share: quality === "high" ? 1 : LEVEL_SHARES[1], reach_m: cascadeReach_m },
      shoots: quality !== "low",
      pullsOf: (holds) => new PullSlots(holds),
      flutter: this.flutter,
      exaggeration: this.exaggeration,
    };
  }

  private treeChanged(change: TreeChange): void {
    this.ownTrees.changed(change);
    this.cards.update(change);
    this.report();
  }

  /** The server has new records: fetch them if they are needed here, or ask the server to use them. */
  private takeRecords(): void {
    this.paper.update();
    if (this.settings.method === "paper" && this.settings.lookup === "server") this.planting.place();
  }

  private async cancel(jobId: string): Promise<void> {
    try {
      await cancelJob(jobId);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      showToast(error.title, error.hint);
    }
  }

  /** Sets the wind from an untrusted document; throws WindError if it is invalid. */
  setWind(document: unknown): void {
    this.changeWind(parseWind(document), "instruments");
  }

  /** The only place that changes the page's wind; the worker already knows a shared one. */
  private changeWind(wind: WindDocument, origin: "panel" | "instruments" | "shared"): void {
    this.settings.wind = wind;
    if (origin !== "panel") this.panel.refresh();
    if (origin !== "shared") this.client.setWind(wind);
    this.studio.showWind();
    if (origin === "shared") this.visit.undo.adopt();
    this.remember("wind");
  }

  /** Called when another client replaced the trees of this shared forest. */
  private takePlacement(about: About): void {
    const before = this.settings.inventory;
    if (!adoptPlacement(this.settings, about)) return;
    this.panel.refresh();
    this.catalogue.choose();
    if (this.settings.inventory === before) this.planting.place();
    else void this.inventory.follow(this.settings.inventory);
    this.paper.chosen();
    this.visit.undo.adopt();
    this.remember("placement");
  }

  /** Plants the stems of a file; in a shared forest the others could not see them. */
  private async openInventory(file: File): Promise<void> {
    if (this.planting.share !== null) {
      showToast("A shared forest cannot be planted from a file.", NOT_SHARED);
      return;
    }
    this.settings.inventory = "";
    await this.inventory.open(file);
    this.remember("inventory");
  }

  /** Plants the inventory of an address; none if it is empty. */
  private followInventory(address: string): void {
    this.settings.inventory = address;
    this.change("inventory");
  }

  private inventoryChanged(): void {
    this.inventoryCard.show(this.inventory.current);
    this.catalogue?.choose();
    this.planting?.place(true);
    if (momentFrom(location.search).eye === null) this.showStand();
  }

  /** Whether an upload has the name of a species in the inventory. */
  private isInInventory(id: string): boolean {
    const { current } = this.inventory;
    if (!current) return false;
    const name = this.catalogue.uploads.find((upload) => upload.id === id)?.name ?? "";
    return current.names.has(id.toLowerCase()) || current.names.has(name.toLowerCase());
  }

  /** Shows all of the stand. */
  private showStand(): void {
    const { current } = this.inventory;
    if (!current) return;
    const { eye, target } = standView(current.report, this.stage.camera.aspect);
    this.look(eye, target);
  }

  /** The forest of this page becomes a shared one: its trees, its wind and its time. Returns whether it can. */
  private startSharing(id: string): boolean {
    if (this.inventory.current && this.settings.inventory === "") {
      showToast("A forest from a file cannot be shared.", NOT_SHARED);
      return false;
    }
    this.planting.share = id;
    this.catalogue.bare = this.playsBareTables;
    this.planting.place(true);
    this.remember("share");
    return true;
  }

  /** Sets season and time of day. */
  setScenery(season: Season, daytime: number): void {
    this.settings.season = season;
    this.settings.daytime = Math.min(1, Math.max(0, daytime));
    this.scenery.show();
    this.change("season");
  }

  /** Applies season and time of day to light, land and leaves. */
  private applyScenery(): void {
    const { daytime, season } = this.settings;
    this.stage.show(daytime, season);
    this.forest.setSeason(season);
    this.stage.shelter(this.forest.crowns);
    this.view.changed = true;
  }

  /** The server moves a shared forest by the tables in leaf, because its clients may look at it in any season. */
  private get playsBareTables(): boolean {
    const { season, lookup } = this.settings;
    return season === "winter" && (this.planting.share === null || lookup === "worker");
  }

  private change(key: SettingKey): void {
    if (key === "season") this.applyScenery();
    if (key === "season" || key === "lookup") this.catalogue.bare = this.playsBareTables;
    if (key === "wind") {
      this.changeWind(this.settings.wind, "panel");
      return;
    }
    if (key === "planted") this.catalogue.choose();
    if (key === "inventory") void this.inventory.follow(this.settings.inventory);
    if (PLACEMENT_KEYS.includes(key)) this.planting.place(key !== "lookup");
    if (key === "method" || key === "lookup") this.paper.chosen();
    if (key === "quality") {
      this.stage.setQuality(this.settings.quality);
      this.forest.options = this.speciesOptions();
      this.planting.place();
    }
    if (key === "background") {
      this.stage.backdrop.shown = this.settings.background;
      this.planting.place();
    }
    if (key === "exaggeration") this.exaggerate();
    this.remember(key);
  }

  /** Settings were replaced by undo or redo. */
  private showReplaced(keys: SettingKey[]): void {
    this.panel.showReplaced();
    this.scenery.show();
    for (const key of keys) {
      if (key === "wind") this.changeWind(this.settings.wind, "instruments");
      else this.change(key);
    }
  }

  /** Sets the factor of all displacements on screen; figures stay as simulated. */
  private exaggerate(): void {
    const factor = this.settings.exaggeration;
    this.exaggeration.value = factor;
    showExaggeration(factor);
    this.view.changed = true;
  }

  /** Stores the settings and updates the URL; `kind` names what was changed. */
  private remember(kind: string): void {
    this.visit.undo.record(kind);
    // The placement of a shared forest is not that of this visitor.
    if (this.settings.panel && this.planting.share === null)
      keep(this.settings, this.defaults, () => localStorage);
    const query = withShared(queryFromSettings(this.settings), this.planting.share);
    history.replaceState(null, "", query ? `?${query}` : location.pathname);
  }

  private report(): void {
    this.panel.showSpecies(this.catalogue.kinds);
    this.panel.uploads.show(this.catalogue.uploads);
    this.panel.showMethodNote(this.paper.note);
    this.status.show(this.connected, this.catalogue.listed);
    this.showPicked();
  }

  private showPicked(): void {
    const { figures } = this.picker;
    const known = figures && this.catalogue.find(figures.treeId);
    this.pickedCard.show(figures, known, known ? this.paper.stateOf(known) : { kind: "missing" });
  }

  /** Tries lost connections to the server at once. */
  private reconnect(): void {
    this.client.retry();
    this.catalogue.retry();
  }

  freeze(frozen: boolean): void {
    this.forest.freeze(frozen);
  }

  /** The trees that are pulled or ring down, by anyone. */
  get pulled() {
    return this.client.pulled;
  }

  get connection() {
    return { ...this.client.connection, events: this.connected };
  }

  /** Moves the camera: eye and target, with heights above the ground, m. */
  look(eye: { x: number; above: number; z: number }, at: { x: number; above: number; z: number }): void {
    this.stage.camera.position.set(eye.x, groundHeight_m(eye.x, eye.z) + eye.above, eye.z);
    this.stage.controls.target.set(at.x, groundHeight_m(at.x, at.z) + at.above, at.z);
  }

  dispose(): void {
    this.loop.stop();
    this.attention.dispose();
    this.graphics.dispose();
    this.puller.dispose();
    this.gusts.dispose();
    this.picker.dispose();
    this.pickedCard.dispose();
    this.ownTrees.dispose();
    this.overlays.dispose();
    this.studio.dispose();
    this.visit.dispose();
    this.inventoryCard.dispose();
    this.comparison.dispose();
    this.catalogue.dispose();
    this.client.dispose();
    this.panel.dispose();
    this.forest.clear();
    this.stage.dispose();
  }
}
