/** Figures of the running forest, for `window.galewood`. */

import { meanCrownDisplacement_m } from "galewood/motion";
import type { MovingGroup } from "../../scene/forest";
import type { PaperMethod } from "../paper/paperMethod";
import type { Catalogue } from "../server/catalogue";
import type { FrameStatistics } from "./frameStatistics";
import type { World } from "./world";

export class ForestFigures {
  constructor(
    private readonly world: World,
    private readonly catalogue: Catalogue,
    private readonly paper: PaperMethod,
    private readonly meter: FrameStatistics,
  ) {}

  get time_s(): number {
    return this.world.client.time_s;
  }

  get readySpecies(): string[] {
    return this.catalogue.ready;
  }

  /** Whether all trees are loaded and planted. */
  get allPlanted(): boolean {
    return this.catalogue.isLoaded && this.world.client.isPlanned;
  }

  get trees() {
    return this.world.forest.trees;
  }

  /** Number of trees of an upload or of a form of a species. */
  planted(treeId: string): number {
    return this.world.forest.count(treeId);
  }

  /** Number of trees that move by the paper's method. */
  get paperTrees(): number {
    return this.count(({ asset }) => {
      const known = this.catalogue.find(asset.id);
      return known !== null && this.paper.moves(known);
    });
  }

  /** Number of trees that move by a table without leaves. */
  get bareTrees(): number {
    return this.count(({ forest }) => forest.motion?.foliage === "bare");
  }

  private count(chosen: (group: MovingGroup) => boolean): number {
    const groups = this.world.forest.moving.filter(chosen);
    return groups.reduce((sum, { forest }) => sum + forest.instances.count, 0);
  }

  get crownDisplacement_m(): [number, number, number] {
    return meanCrownDisplacement_m(
      this.world.forest.moving.flatMap(({ forest: { motion, instances } }, k) => {
        const poses = this.world.client.poses[k];
        return motion && poses
          ? [{ ...motion, count: instances.count, placement: instances.placement, poses }]
          : [];
      }),
    );
  }

  /** Cost of the page: frame, script and worker times, triangles. */
  get statistics() {
    const { frame_ms, script_ms, triangles, drawCalls } = this.meter.statistics;
    const { work, extrapolationRatio } = this.world.client;
    return { frame_ms, script_ms, triangles, drawCalls, work, extrapolationRatio };
  }
}
