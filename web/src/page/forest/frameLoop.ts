/** The frame loop: advances all that moves, draws the picture, and reports a few times per second. */

import type { Catalogue } from "../server/catalogue";
import type { Store } from "../store/store";
import { type FrameStatistics, isFrameDue, MAX_FRAME_S } from "./frameStatistics";
import type { World } from "./world";

const REPORT_EVERY_MS = 250;
/** The land is drawn without trees only if these take longer: its first picture would delay them. */
const LAND_AFTER_MS = 3000;
/** Pictures in which the first trees are seen to move. */
const MOTION_PICTURES = 3;
/** The scene stays static for this long while the first trees are loading. */
const PATIENCE_MS = 4000;
/** Plants and shadows wait for this long for trees that are loading. */
const SURROUNDINGS_AFTER_MS = 8000;

/** One picture of the forest. */
export interface Frame {
  /** Time since the last picture, s. */
  readonly passed_s: number;
  /** Time by which the motion advances, s; 0 while it stands still. */
  readonly played_s: number;
  /** Whether the trees move; otherwise they keep their poses. */
  readonly playing: boolean;
}

/** What a feature does in every frame. */
export interface FramePart {
  /** After the trees have moved. */
  advance?(frame: Frame): void;
  /** Right after a picture was drawn. */
  drawn?(): void;
  /** A few times per second: refreshes what the page says in figures. */
  report?(): void;
}

export class FrameLoop {
  /** Number of frames drawn. */
  frame = 0;
  /** Number of pictures with trees, as long as few have been drawn. */
  private withTrees = 0;
  /** Whether the graphics have finished the last picture. */
  private isFinished: () => boolean = () => true;
  private last_ms = performance.now();
  private reported_ms = 0;

  /** `parts` advance in this order. */
  constructor(
    private readonly store: Store,
    private readonly world: World,
    private readonly catalogue: Pick<Catalogue, "isLoaded">,
    private readonly meter: FrameStatistics,
    private readonly parts: readonly FramePart[],
  ) {}

  start(): void {
    this.world.stage.renderer.setAnimationLoop((now_ms) => this.onFrame(now_ms));
  }

  report(): void {
    for (const part of this.parts) part.report?.();
  }

  private onFrame(now_ms: number): void {
    const { settings, state, playback } = this.store;
    if (state.asleep || this.world.isUnseen) return;
    const frame_ms = now_ms - this.last_ms;
    if (!isFrameDue(frame_ms, settings.frameRateLimit_hz)) return;
    // The browser would have further pictures wait for slow graphics, while the trees have moved on.
    if (!state.treesSeen && !this.isFinished()) return;
    const begin_ms = performance.now();
    const passed_s = state.stopped ? 0 : Math.min(MAX_FRAME_S, Math.max(0, frame_ms / 1000));
    this.last_ms = now_ms;
    const played_s = playback.advance_s(passed_s, settings.lookup === "server");
    const early = !this.world.hasTrees && performance.now() < LAND_AFTER_MS;
    if (!early) {
      this.move({ passed_s, played_s: played_s ?? 0, playing: played_s !== null }, this.more);
      this.draw(passed_s);
    }
    this.meter.count(frame_ms, performance.now() - begin_ms);
    if (now_ms - this.reported_ms > REPORT_EVERY_MS) {
      this.reported_ms = now_ms;
      this.report();
    }
  }

  /** `more`: see Stage.advance. */
  private move(frame: Frame, more: number): void {
    if (frame.playing) this.world.moveTrees(frame.played_s);
    for (const part of this.parts) part.advance?.(frame);
    this.world.moveScenery(frame.played_s, more);
  }

  /** Advances by dt_s and waits for the poses; for frame-by-frame rendering while asleep. */
  async step(dt_s: number, drawn = true): Promise<void> {
    this.move({ passed_s: dt_s, played_s: dt_s, playing: true }, Number.POSITIVE_INFINITY);
    await this.world.settle();
    if (drawn) this.draw(dt_s);
    else this.frame++;
    this.report();
  }

  /** Skip drawing until the first trees have moved: before that only the clouds would. */
  private get waitsForTrees(): boolean {
    const { state, playback, from_s } = this.store;
    if (performance.now() > PATIENCE_MS) return false;
    const steps = !state.stopped && !playback.paused;
    return !this.world.hasTrees || (steps && this.world.client.time_s <= from_s);
  }

  /** What is around the trees waits until they are there; then it comes piece by piece, and the trees move meanwhile. */
  private get more(): number {
    if (performance.now() > SURROUNDINGS_AFTER_MS) return 1;
    return this.store.state.treesSeen && this.catalogue.isLoaded ? 1 : 0;
  }

  private countWithTrees(): void {
    this.isFinished = this.world.stage.fence();
    this.store.state.treesSeen = ++this.withTrees >= MOTION_PICTURES;
  }

  private draw(passed_s: number): void {
    const { state } = this.store;
    if (this.world.draw(passed_s, this.waitsForTrees)) {
      if (this.world.hasTrees && !state.treesSeen) this.countWithTrees();
      for (const part of this.parts) part.drawn?.();
    }
    this.frame++;
  }
}
