/** The atlases of all trees that may be drawn as impostors, baked a few views per frame. */

import type { TableMotion } from "galewood/client";
import type { TreeModel } from "galewood/trees";
import type { Object3D, WebGLRenderer } from "three";
import { Atlas } from "./baking/atlas";
import { MOST_ATLASES, viewsPerFrame } from "./baking/atlasLayout";
import { Baker } from "./baking/baker";
import { SimulatedCards } from "./simulatedCards";

/** Frames that are drawn before baking begins, so that it does not delay the first moving tree. */
const HEAD_START = 3;

export class ImpostorLibrary {
  private readonly atlases = new Map<TreeModel, Atlas>();
  private baker: Baker;
  private leafless = false;
  private waited = 0;
  private last_ms = 0;
  /** Distance (m) from which simulated trees of scale 1 are drawn as impostors. */
  from_m = Number.POSITIVE_INFINITY;
  /** Set while impostors come nearer after they have become available: trees must be selected again. */
  arriving = false;
  /** Increases with every atlas that becomes complete. */
  version = 0;

  /** `side`: size of the picture from which each view is reduced, px. */
  constructor(side: number) {
    this.baker = new Baker(side);
  }

  setDetail(side: number): void {
    if (side === this.baker.side) return;
    this.baker.dispose();
    this.baker = new Baker(side);
  }

  /** Keeps atlases for these trees, the first of them if there are too many, and frees all others. */
  keep(models: readonly TreeModel[]): void {
    const kept = new Set(models.slice(0, MOST_ATLASES));
    for (const [model, atlas] of this.atlases) {
      if (kept.has(model)) continue;
      atlas.dispose();
      this.atlases.delete(model);
      this.baker.rest();
    }
    for (const model of kept) {
      if (this.atlases.has(model)) continue;
      const atlas = new Atlas(model);
      atlas.restart(this.leafless);
      this.atlases.set(model, atlas);
    }
  }

  /** The atlas of a tree once all its views exist. */
  atlasOf(model: TreeModel): Atlas | null {
    const atlas = this.atlases.get(model);
    return atlas?.complete ? atlas : null;
  }

  /** Whether the trees have leaves; the atlases are baked again. */
  setLeafless(leafless: boolean): void {
    if (leafless === this.leafless) return;
    this.leafless = leafless;
    for (const atlas of this.atlases.values()) if (!atlas.model.evergreen) atlas.restart(leafless);
  }

  /** After a loss of the graphics context: its pictures are gone. */
  renew(): void {
    this.baker.forget();
    for (const atlas of this.atlases.values()) {
      atlas.complete = false;
      atlas.restart(this.leafless);
    }
    this.version++;
  }

  /** Impostors for the simulated trees of a species. */
  cardsFor(model: TreeModel, group: Object3D, motion: TableMotion): SimulatedCards {
    return new SimulatedCards(this, model, group, motion);
  }

  get isReady(): boolean {
    return this.atlases.size > 0 && [...this.atlases.values()].every(({ isBaked }) => isBaked);
  }

  /** Per frame: draws some views. Returns whether another atlas became complete. */
  work(renderer: WebGLRenderer): boolean {
    const now_ms = performance.now();
    const frame_ms = now_ms - this.last_ms;
    this.last_ms = now_ms;
    const next = [...this.atlases.values()].find(({ isBaked }) => !isBaked);
    if (!next) return false;
    if (this.waited++ < HEAD_START) return false;
    const before = next.complete;
    this.baker.work(renderer, next, viewsPerFrame(frame_ms));
    if (next.isBaked && this.isReady) this.baker.rest();
    if (before || !next.complete) return false;
    this.version++;
    return true;
  }

  dispose(): void {
    for (const atlas of this.atlases.values()) atlas.dispose();
    this.atlases.clear();
    this.baker.dispose();
  }
}
