/** The application: connects stage, forest, worker, catalogue and panel, and runs the frame loop. */

import { meanVelocity_m_s, sameWind } from "../core/wind/edit";
import { parseWind, type WindDocument } from "../core/wind/wind";
import type { About } from "../core/wire/wire";
import { Forest } from "../scene/forest";
import { groundHeight_m } from "../scene/ground/landscape";
import type { Season } from "../scene/season/season";
import { seasonal } from "../scene/season/seasonal";
import { aerialPerspective } from "../scene/sky/air";
import { Stage } from "../scene/stage";
import type { SpeciesOptions } from "../scene/trees/speciesForest";
import { Comparison } from "./compare/comparison";
import { ForestClient } from "./forestClient";
import { ForestFigures } from "./forestFigures";
import { FrameStatistics } from "./frameStatistics";
import { PaperMethod } from "./paper/paperMethod";
import { Planting } from "./planting";
import { Playback } from "./playback";
import { Gusts } from "./pulling/gusts";
import { Puller } from "./pulling/puller";
import { showPulls } from "./pulling/showPulls";
import { cancelJob, Problem, type TreeChange, useKeys } from "./server/api";
import { Catalogue } from "./server/catalogue";
import { queryFromSettings, type Settings } from "./settings/settings";
import { adoptPlacement, withShared } from "./settings/sharedForest";
import { keep } from "./settings/storedSettings";
import { StatusReport } from "./statusReport";
import { TreePicker } from "./treePicker";
import { element } from "./ui/dom";
import { askForKey, keptKey } from "./ui/keyDialog";
import { Panel, type SettingKey } from "./ui/panel";
import { PickedCard } from "./ui/pickedCard";
import { ProgressCards } from "./ui/progress";
import { SceneryBar } from "./ui/scenery";
import { showToast } from "./ui/toast";
import { Visit } from "./visit";
import { WindStudio } from "./windStudio";

const REPORT_EVERY_MS = 250;
/** The scene stays static for this long while the first trees are loading. */
const PATIENCE_MS = 4000;
const PLACEMENT_KEYS: SettingKey[] = [
  "trees",
  "density",
  "shares",
  "form",
  "forestSeed",
  "lookup",
  "method",
  "poseEasing",
];

export class App {
  readonly stage: Stage;
  frame = 0;
  private stopped = false;
  /** While true, the forest neither advances nor draws, to leave the processor to other work. */
  asleep = false;
  private readonly client = new ForestClient(showToast, {
    placement: (about) => this.takePlacement(about),
    wind: (wind) => {
      if (!sameWind(wind, this.settings.wind)) this.changeWind(wind, "shared");
    },
  });
  private readonly catalogue: Catalogue;
  private readonly paper: PaperMethod;
  private readonly forest: Forest;
  private readonly planting: Planting;
  private readonly comparison: Comparison;
  readonly figures: ForestFigures;
  private readonly cards = new ProgressCards();
  private readonly panel: Panel;
  readonly studio: WindStudio;
  readonly visit: Visit;
  private readonly scenery: SceneryBar;
  readonly picker: TreePicker;
  readonly puller: Puller;
  private readonly gusts: Gusts;
  private readonly pickedCard: PickedCard;
  readonly playback = new Playback();
  private readonly meter = new FrameStatistics();
  private readonly status: StatusReport;
  private readonly flutter = { value: { x: 0, y: 0 } };
  private connected = true;
  private dirty = true;
  private last_ms = performance.now();
  private reported_ms = 0;

  /** Settings are stored as differences from `defaults`. */
  constructor(
    readonly settings: Settings,
    private readonly defaults: Settings,
  ) {
    useKeys({ known: keptKey, ask: askForKey });
    this.stage = new Stage(element<HTMLCanvasElement>("view"), settings.quality);
    this.forest = new Forest(this.speciesOptions());
    this.stage.scene.add(this.forest.group);
    this.applyScenery();
    this.scenery = new SceneryBar(settings, () => this.change("season"));
    this.visit = new Visit(
      settings,
      this.stage,
      this.forest,
      () => this.catalogue,
      () => this.client.time_s,
      () => void this.comparison.open(),
      this.playback,
    );
    this.visit.restore(location.search);
    this.panel = new Panel(settings, this.meter.statistics, this.playback, (key) => this.change(key));
    this.catalogue = new Catalogue((sha256) => this.client.loadTable(sha256), {
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
    this.planting = new Planting(settings, this.stage, this.forest, this.client, this.catalogue, () => {
      this.dirty = true;
    });
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
    const moves = () => !this.paused && !this.playback.paused;
    this.puller = new Puller(this.stage, this.forest, this.client, this.picker, moves);
    this.gusts = new Gusts(this.stage, this.client);
    this.picker.onGround = (x_m, z_m) => this.gusts.send(x_m, z_m);
    this.pickedCard = new PickedCard({
      follow: (following) => {
        this.picker.following = following;
      },
      compare: () => void this.comparison.open(),
      physics: () => this.visit.openPhysics(),
      cancel: (jobId) => void this.cancel(jobId),
      close: () => this.picker.select(null),
    });
    const { stage, forest, client, catalogue, paper, meter, picker } = this;
    this.comparison = new Comparison(forest, client, catalogue, picker, (busy) => {
      // The forest stops meanwhile, to leave the processor to the comparison.
      this.asleep = busy;
    });
    this.status = new StatusReport(settings, stage, forest, client, meter);
    this.figures = new ForestFigures(forest, client, catalogue, paper, meter);
    this.stage.renderer.setAnimationLoop((now) => this.onFrame(now));
  }

  private speciesOptions(): SpeciesOptions {
    const { quality } = this.settings;
    const { capabilities } = this.stage.renderer;
    return {
      maxTextureSide: Math.min(capabilities.maxTextureSize, 4096),
      anisotropy: quality === "low" ? 1 : Math.min(4, capabilities.getMaxAnisotropy()),
      smoothEdges: quality !== "low",
      gloss: quality === "high",
      surface: seasonal,
      atmosphere: aerialPerspective,
      flutter: this.flutter,
    };
  }

  private treeChanged(change: TreeChange): void {
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
    this.remember();
  }

  /** Called when another client replaced the trees of this shared forest. */
  private takePlacement(about: About): void {
    if (!adoptPlacement(this.settings, about)) return;
    this.panel.refresh();
    this.planting.place();
    this.paper.chosen();
    this.remember();
  }

  get paused(): boolean {
    return this.stopped;
  }

  set paused(paused: boolean) {
    this.stopped = paused;
    this.client.pause(paused);
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
    this.dirty = true;
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
    if (PLACEMENT_KEYS.includes(key)) this.planting.place(key !== "lookup");
    if (key === "method" || key === "lookup") this.paper.chosen();
    if (key === "quality") {
      this.stage.setQuality(this.settings.quality);
      this.forest.options = this.speciesOptions();
      this.planting.place();
    }
    this.remember();
  }

  /** Stores the settings and updates the URL. */
  private remember(): void {
    if (this.settings.panel) keep(this.settings, this.defaults, () => localStorage);
    const query = withShared(queryFromSettings(this.settings), this.planting.share);
    history.replaceState(null, "", query ? `?${query}` : location.pathname);
  }

  private onFrame(now_ms: number): void {
    if (this.asleep) return;
    const begin_ms = performance.now();
    const frame_ms = now_ms - this.last_ms;
    const dt_s = this.paused ? 0 : Math.min(0.25, Math.max(0, frame_ms / 1000));
    this.last_ms = now_ms;
    this.visit.advance(dt_s);
    const played_s = this.playback.advance_s(dt_s, this.settings.lookup === "server");
    this.move(played_s ?? 0, played_s !== null);
    this.draw();
    this.frame++;
    this.meter.count(frame_ms, performance.now() - begin_ms);
    if (now_ms - this.reported_ms > REPORT_EVERY_MS) {
      this.reported_ms = now_ms;
      this.report();
    }
  }

  /** Advances by dt_s; without `playing` the trees keep their poses. */
  private move(dt_s: number, playing = true): void {
    if (playing && !this.paused) this.client.advance(dt_s);
    if (playing) this.takePoses();
    this.picker.enabled = !this.studio.isPlacing;
    this.picker.advance(dt_s);
    this.puller.advance();
    this.gusts.advance();
    this.studio.tipOf = this.picker.moving;
    this.studio.advance(dt_s, this.client, this.forest);
    const wind_m_s = meanVelocity_m_s(this.settings.wind);
    this.stage.sky.advance(dt_s, wind_m_s);
    this.stage.cover.update(this.stage.camera.position, wind_m_s, this.client.time_s);
    this.flutter.value.x += dt_s;
    this.flutter.value.y = this.settings.flutter ? 1 : 0;
  }

  private takePoses(): void {
    if (!this.client.takeFreshPoses()) return;
    for (const [k, { forest }] of this.forest.moving.entries()) forest.setPoses(this.client.poses[k]);
    showPulls(this.forest, this.client);
  }

  /** Advances by dt_s and waits for the poses; for frame-by-frame rendering while asleep. */
  async step(dt_s: number, drawn = true): Promise<void> {
    this.visit.advance(dt_s);
    this.move(dt_s);
    while (this.client.isBusy) await new Promise((done) => setTimeout(done, 1));
    this.takePoses();
    if (drawn) this.draw();
    this.frame++;
  }

  /** Skip drawing while the first trees are loading, because only the clouds would move. */
  private get waitsForTrees(): boolean {
    return this.frame > 0 && this.forest.group.children.length === 0 && performance.now() < PATIENCE_MS;
  }

  private draw(): void {
    const { stage, forest } = this;
    const moved = stage.updateCamera();
    if (!moved && !this.dirty && this.waitsForTrees) return;
    if (moved || this.dirty) forest.select(stage.view());
    this.dirty = false;
    stage.renderer.info.reset();
    forest.renderNodes(stage.renderer);
    stage.render();
    this.visit.drawn();
  }

  private report(): void {
    this.panel.showSpecies(this.catalogue.kinds);
    this.panel.showMethodNote(this.paper.note);
    this.status.show(this.connected, this.catalogue.waiting);
    this.showPicked();
  }

  private showPicked(): void {
    const { figures } = this.picker;
    const known = figures && this.catalogue.find(figures.treeId);
    this.pickedCard.show(figures, known, known ? this.paper.stateOf(known) : { kind: "missing" });
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
    this.stage.renderer.setAnimationLoop(null);
    this.puller.dispose();
    this.gusts.dispose();
    this.picker.dispose();
    this.pickedCard.dispose();
    this.studio.dispose();
    this.visit.dispose();
    this.comparison.dispose();
    this.catalogue.dispose();
    this.client.dispose();
    this.panel.dispose();
    this.forest.clear();
    this.stage.dispose();
  }
}
