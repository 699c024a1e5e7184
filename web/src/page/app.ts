/** The application: connects stage, forest, worker, catalogue and panel. */

import { sameWind } from "galewood/wind";
import { exaggeration } from "../scene/exaggeration";
import { Forest } from "../scene/forest";
import { groundHeight_m } from "../scene/ground/landscape";
import type { Season } from "../scene/season/season";
import { Stage } from "../scene/stage";
import { Attention } from "./attention";
import { Changes, type ChangingParts } from "./changes";
import { Comparison } from "./compare/comparison";
import { ContextLoss } from "./contextLoss";
import type { DataFiles } from "./files/dataFiles";
import { ForestClient } from "./forestClient";
import { ForestFigures } from "./forestFigures";
import { FrameLoop } from "./frameLoop";
import { FrameStatistics } from "./frameStatistics";
import { InventoryPlanting } from "./inventory/inventoryPlanting";
import { TreeOverlays } from "./overlays/treeOverlays";
import { OwnTrees } from "./ownTree/ownTrees";
import type { OwnUploads } from "./ownTree/ownUploads";
import { PaperMethod } from "./paper/paperMethod";
import { PickedTreeCard } from "./pickedTreeCard";
import { Planting } from "./planting";
import { Playback } from "./playback";
import { Gusts } from "./pulling/gusts";
import { Puller } from "./pulling/puller";
import { type TreeChange, useKeys } from "./server/api";
import { Catalogue } from "./server/catalogue";
import { plantedAs } from "./settings/planted";
import type { Settings } from "./settings/settings";
import { sharedFrom } from "./settings/sharedForest";
import { WindSound } from "./sound";
import { speciesOptions } from "./speciesOptions";
import { StatusReport } from "./statusReport";
import { TreePicker } from "./treePicker";
import { element } from "./ui/dom";
import { askForKey, keptKey } from "./ui/keyDialog";
import { Panel } from "./ui/panel";
import { ProgressCards } from "./ui/progress";
import { SceneryBar } from "./ui/scenery";
import { showToast } from "./ui/toast";
import { Visit } from "./visit";
import { WindStudio } from "./windStudio";

export class App implements ChangingParts {
  private readonly changes = new Changes(this);
  readonly stage: Stage;
  readonly client = new ForestClient(showToast, {
    placement: (about) => this.changes.takePlacement(about),
    present: (clients) => this.visit.sharing.present(clients),
    wind: (wind) => {
      if (!sameWind(wind, this.settings.wind)) this.changes.changeWind(wind, "shared");
    },
  });
  readonly catalogue: Catalogue;
  readonly paper: PaperMethod;
  readonly forest: Forest;
  readonly planting: Planting;
  readonly inventory: InventoryPlanting;
  private readonly comparison: Comparison;
  readonly figures: ForestFigures;
  private readonly cards: ProgressCards;
  private readonly ownTrees: OwnTrees;
  readonly panel: Panel;
  readonly studio: WindStudio;
  readonly overlays: TreeOverlays;
  readonly visit: Visit;
  readonly scenery: SceneryBar;
  readonly picker: TreePicker;
  readonly puller: Puller;
  private readonly gusts: Gusts;
  private readonly pickedCard: PickedTreeCard;
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
  readonly flutter = { value: { x: 0, y: 0 } };
  /** Whether the trees to draw must be selected again. */
  readonly view = { changed: true };
  private connected = true;
  readonly loop: FrameLoop;

  /** Settings are stored as differences from `defaults`. */
  constructor(
    readonly settings: Settings,
    readonly defaults: Settings,
    uploads: OwnUploads,
    files: DataFiles,
  ) {
    useKeys({ known: keptKey, ask: askForKey });
    this.stage = new Stage(element<HTMLCanvasElement>("view"), settings.quality);
    // three.js creates its own resources again when it draws; what depends on the view is selected again.
    this.graphics = new ContextLoss(this.stage.renderer.domElement, () => this.changes.applyScenery());
    this.stage.backdrop.shown = settings.background;
    this.forest = new Forest(
      speciesOptions(settings.quality, this.stage, this.flutter),
      this.stage.backdrop.library,
    );
    this.stage.scene.add(this.forest.group);
    this.changes.applyScenery();
    this.changes.exaggerate();
    this.scenery = new SceneryBar(settings, () => this.changes.apply("season"));
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
        replaced: (keys) => this.changes.replaced(keys),
        share: () => this.planting?.share ?? sharedFrom(location.search),
        startSharing: (id) => this.changes.startSharing(id),
      },
    );
    this.visit.restore(location.search);
    this.panel = new Panel(
      settings,
      this.meter.statistics,
      this.playback,
      this.sound,
      (key) => this.changes.apply(key),
      (id, how) => this.ownTrees.plant(id, how),
    );
    this.catalogue = new Catalogue((sha256) => this.client.loadTable(sha256), {
      isPlanted: (id) => plantedAs(settings, id) !== null || this.inventory.holds(id),
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
    const page = this;
    this.inventory = new InventoryPlanting({
      settings,
      stage: this.stage,
      catalogue: this.catalogue,
      get planting() {
        return page.planting;
      },
      look: (eye, at) => this.look(eye, at),
      changed: () => this.changes.apply("inventory"),
      remember: () => this.changes.remember("inventory"),
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
      this.inventory.forest,
    );
    this.ownTrees = new OwnTrees(uploads, {
      settings,
      stage: this.stage,
      forest: this.forest,
      catalogue: this.catalogue,
      visit: this.visit,
      isShared: () => this.planting.share !== null,
      replant: () => this.changes.apply("planted"),
      planted: (id) => this.cards.planted(id),
    });
    this.cards = new ProgressCards(this.ownTrees);
    this.catalogue.bare = this.changes.playsBareTables;
    this.paper = new PaperMethod(settings, {
      trees: () => this.catalogue.known,
      load: (table, records) => this.client.loadRecords(table, records),
      arrived: () => this.planting.place(),
      problem: showToast,
    });
    this.studio = new WindStudio(this.stage, settings, {
      wind: (wind) => this.changes.changeWind(wind, "instruments"),
      problem: showToast,
    });
    this.picker = new TreePicker(this.stage, this.forest, this.client, () => this.pickedCard.show());
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
      exaggeration,
    });
    const { stage, forest, client, catalogue, paper, meter, picker } = this;
    this.comparison = new Comparison(forest, client, catalogue, picker, (busy) => {
      // The forest stops meanwhile, to leave the processor to the comparison.
      this.loop.asleep = busy;
    });
    this.status = new StatusReport(settings, stage, forest, client, meter, () => this.reconnect());
    this.pickedCard = new PickedTreeCard(this.overlays.menu.element, {
      settings,
      picker,
      catalogue,
      paper,
      ownTrees: this.ownTrees,
      visit: this.visit,
      comparison: this.comparison,
    });
    this.figures = new ForestFigures(forest, client, catalogue, paper, meter);
    if (settings.inventory !== "") this.inventory.follow();
    files.connect({
      inventory: (file) => void this.inventory.open(file),
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

  /** Sets the wind from an untrusted document; throws WindError if it is invalid. */
  setWind(document: unknown): void {
    this.changes.setWind(document);
  }

  /** Sets season and time of day. */
  setScenery(season: Season, daytime: number): void {
    this.changes.setScenery(season, daytime);
  }

  private report(): void {
    this.panel.showSpecies(this.catalogue.kinds);
    this.panel.uploads.show(this.catalogue.uploads);
    this.panel.showMethodNote(this.paper.note);
    this.status.show(this.connected, this.catalogue.listed);
    this.pickedCard.show();
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
    this.inventory.dispose();
    this.comparison.dispose();
    this.catalogue.dispose();
    this.client.dispose();
    this.panel.dispose();
    this.forest.clear();
    this.stage.dispose();
  }
}
