/** The frame loop: advances all that moves, draws the picture, and reports a few times per second. */

import { meanVelocity_m_s } from "galewood/wind";
import type { Forest } from "../scene/forest";
import type { Stage } from "../scene/stage";
import type { ForestClient } from "./forestClient";
import { type FrameStatistics, isFrameDue } from "./frameStatistics";
import type { TreeOverlays } from "./overlays/treeOverlays";
import type { OwnTrees } from "./ownTree/ownTrees";
import type { Planting } from "./planting";
import type { Playback } from "./playback";
import type { Gusts } from "./pulling/gusts";
import type { Puller } from "./pulling/puller";
import { showPulls } from "./pulling/showPulls";
import type { Settings } from "./settings/settings";
import type { WindSound } from "./sound";
import type { TreePicker } from "./treePicker";
import type { Visit } from "./visit";
import type { WindStudio } from "./windStudio";

const REPORT_EVERY_MS = 250;
/** The scene stays static for this long while the first trees are loading. */
const PATIENCE_MS = 4000;

/** What a frame advances and draws. */
export interface LoopParts {
  readonly settings: Settings;
  readonly stage: Stage;
  readonly forest: Forest;
  readonly client: ForestClient;
  readonly planting: Planting;
  readonly visit: Visit;
  readonly playback: Playback;
  readonly picker: TreePicker;
  readonly ownTrees: OwnTrees;
  readonly puller: Puller;
  readonly gusts: Gusts;
  readonly studio: WindStudio;
  readonly overlays: TreeOverlays;
  readonly sound: WindSound;
  readonly meter: FrameStatistics;
  /** Uniform of the leaf flutter: time, s, and whether leaves flutter. */
  readonly flutter: { value: { x: number; y: number } };
  /** Whether the trees to draw must be selected again. */
  readonly view: { changed: boolean };
  /** Whether nobody can see a picture: the page is hidden, or its graphics context lost. */
  isUnseen(): boolean;
  /** Refreshes what the page says in figures. */
  report(): void;
}

export class FrameLoop {
  /** Number of frames drawn. */
  frame = 0;
  /** While true, the forest neither advances nor draws, to leave the processor to other work. */
  asleep = false;
  private stopped = false;
  private last_ms = performance.now();
  private reported_ms = 0;

  constructor(private readonly parts: LoopParts) {}

  start(): void {
    this.parts.stage.renderer.setAnimationLoop((now_ms) => this.onFrame(now_ms));
  }

  stop(): void {
    this.parts.stage.renderer.setAnimationLoop(null);
  }

  get paused(): boolean {
    return this.stopped;
  }

  set paused(paused: boolean) {
    this.stopped = paused;
    this.parts.client.pause(paused);
  }

  private onFrame(now_ms: number): void {
    if (this.asleep || this.parts.isUnseen()) return;
    const frame_ms = now_ms - this.last_ms;
    if (!isFrameDue(frame_ms, this.parts.settings.frameRateLimit_hz)) return;
    const begin_ms = performance.now();
    const dt_s = this.paused ? 0 : Math.min(0.25, Math.max(0, frame_ms / 1000));
    this.last_ms = now_ms;
    this.parts.visit.advance(dt_s);
    const played_s = this.parts.playback.advance_s(dt_s, this.parts.settings.lookup === "server");
    this.move(played_s ?? 0, played_s !== null);
    this.draw(dt_s);
    this.frame++;
    this.parts.meter.count(frame_ms, performance.now() - begin_ms);
    if (now_ms - this.reported_ms > REPORT_EVERY_MS) {
      this.reported_ms = now_ms;
      this.parts.report();
    }
  }

  /** Advances by dt_s; without `playing` the trees keep their poses. */
  private move(dt_s: number, playing = true): void {
    const { settings, stage, forest, client, picker, studio, flutter } = this.parts;
    const { position } = stage.camera;
    if (playing && !this.paused) client.advance(dt_s, position);
    if (playing) this.takePoses();
    picker.advance(dt_s);
    this.parts.ownTrees.advance();
    this.parts.puller.advance();
    this.parts.gusts.advance();
    studio.tipOf = picker.moving;
    this.parts.overlays.advance(playing ? dt_s : 0);
    this.parts.sound.advance(studio.field, position, client.time_s, playing);
    studio.advance(dt_s, client, forest);
    stage.advance(dt_s, meanVelocity_m_s(settings.wind), client.time_s);
    if (client.wind) stage.backdrop.wood.advance(client.wind.state, client.time_s);
    flutter.value.x += dt_s;
    flutter.value.y = settings.flutter ? 1 : 0;
  }

  private takePoses(): void {
    const { forest, client } = this.parts;
    if (!client.takeFreshPoses()) return;
    for (const [k, moving] of forest.moving.entries()) moving.forest.setPoses(client.poses[k]);
    showPulls(forest, client);
  }

  /** Advances by dt_s and waits for the poses; for frame-by-frame rendering while asleep. */
  async step(dt_s: number, drawn = true): Promise<void> {
    this.parts.visit.advance(dt_s);
    this.move(dt_s);
    while (this.parts.client.isBusy) await new Promise((done) => setTimeout(done, 1));
    this.takePoses();
    if (drawn) this.draw(dt_s);
    this.frame++;
  }

  /** Skip drawing until the first trees have moved: before that only the clouds would. */
  private get waitsForTrees(): boolean {
    if (this.frame === 0 || performance.now() > PATIENCE_MS) return false;
    const steps = !this.paused && !this.parts.playback.paused;
    return !this.hasTrees || (steps && this.parts.client.time_s <= this.parts.planting.from_s);
  }

  private get hasTrees(): boolean {
    return this.parts.forest.group.children.length > 0;
  }

  /** `dt_s`: time since the last picture. */
  private draw(dt_s: number): void {
    const { stage, forest, view } = this.parts;
    view.changed = stage.updateCamera() || view.changed;
    if (this.waitsForTrees && (this.hasTrees || !view.changed)) return;
    if (view.changed) {
      forest.select(stage.view());
      stage.backdrop.select(stage.view());
    }
    view.changed = false;
    stage.renderer.info.reset();
    forest.renderNodes(stage.renderer);
    stage.render(dt_s);
    this.parts.visit.drawn();
  }
}
