/** The tree animated from its table, overlaid with the reference solution as a ghost. */

import type { TableMotion } from "galewood/client";
import type { Method } from "galewood/motion";
import type { TreeModel } from "galewood/trees";
import { PreviewStage } from "../../scene/previewStage";
import { BentTree } from "./bentTree";
import { poseAt, type Tracks } from "./tracks";

/** Error relative to the height that is shown in full red. */
export const FULL_RED_ERROR_SHARE = 0.02;

/** Display options of a comparison. */
export interface Shown {
  method: Method;
  ghost: boolean;
  /** Magnification of the motion. */
  times: number;
}

export class ComparisonScene {
  private readonly stage: PreviewStage;
  private solid: BentTree | null = null;
  private ghost: BentTree | null = null;
  private pose = new Float32Array(0);

  constructor(canvas: HTMLCanvasElement) {
    this.stage = new PreviewStage(canvas);
  }

  /** Replaces the tree. */
  setTree(model: TreeModel, motion: TableMotion): void {
    this.clear();
    this.solid = new BentTree(model, motion, false);
    this.ghost = new BentTree(model, motion, true);
    this.pose = new Float32Array(motion.modes);
    this.stage.scene.add(this.solid.group, this.ghost.group);
    this.stage.frame(model);
  }

  /** Shows the comparison at a fractional frame `place`. */
  show(tracks: Tracks, place: number, { method, ghost, times }: Shown): void {
    if (!this.solid || !this.ghost) return;
    poseAt(tracks.q[method] ?? tracks.q.modal, tracks.modes, place, this.pose);
    this.solid.bend(this.pose, times);
    poseAt(tracks.q.fem, tracks.modes, place, this.pose);
    this.ghost.bend(this.pose, times);
    this.solid.show();
    this.solid.paint(this.ghost.pose, times * FULL_RED_ERROR_SHARE * tracks.height_m);
    this.ghost.group.visible = ghost;
    if (ghost) this.ghost.show();
  }

  render(): void {
    this.stage.render();
  }

  private clear(): void {
    for (const tree of [this.solid, this.ghost]) {
      if (!tree) continue;
      this.stage.scene.remove(tree.group);
      tree.dispose();
    }
  }
}
