/** Impostors of the simulated trees of one species, from some distance on. */

import type { TableMotion } from "galewood/client";
import type { DrawList, LevelTexels, TreeModel } from "galewood/trees";
import { bendNodes, type FarCards, fillCards } from "galewood/trees";
import type { Object3D, Texture } from "three";
import type { Atlas } from "./baking/atlas";
import { Cards } from "./cards";

/** The part of the library that is needed here. */
export interface AtlasSource {
  readonly from_m: number;
  arriving: boolean;
  atlasOf(model: TreeModel): Atlas | null;
}

/** When an atlas is complete, impostors begin out here and come nearer, so that no tree changes at once. */
const ARRIVAL_FADE = { from_m: 420, time_ms: 1500 };

export class SimulatedCards implements FarCards {
  private cards: Cards | null = null;
  private since_ms = 0;
  /** Height of the middle node by which cards bend, relative to the tip. */
  private readonly middleAt: number;

  constructor(
    private readonly library: AtlasSource,
    private readonly model: TreeModel,
    private readonly group: Object3D,
    private readonly motion: Pick<TableMotion, "rest_m" | "height_m" | "levels">,
  ) {
    this.middleAt = bendNodes(motion).middleAt;
  }

  get from_m(): number {
    const atlas = this.library.atlasOf(this.model);
    if (!atlas) {
      // Not disposed of: after a loss of the graphics context the same atlas is baked again.
      this.cards?.seen.show(0);
      return Number.POSITIVE_INFINITY;
    }
    if (this.cards?.atlas !== atlas) this.take(atlas);
    const way = Math.min(1, (performance.now() - this.since_ms) / ARRIVAL_FADE.time_ms);
    if (way < 1) this.library.arriving = true;
    return ARRIVAL_FADE.from_m + (this.library.from_m - ARRIVAL_FADE.from_m) * way;
  }

  private take(atlas: Atlas): void {
    this.drop();
    this.cards = new Cards(atlas, this.middleAt);
    this.cards.addTo(this.group);
    this.since_ms = performance.now();
  }

  private drop(): void {
    this.cards?.dispose();
    this.cards = null;
  }

  show(
    list: DrawList,
    instances: Float32Array,
    texels: readonly LevelTexels[],
    nodes: Texture,
    shift: number,
  ): void {
    if (!this.cards) return;
    const { seen, uniforms } = this.cards;
    seen.reserve(list.drawn);
    const count = fillCards(seen, list, instances, texels, this.motion.levels);
    uniforms.uNodes.value = nodes;
    uniforms.uNodeShift.value = shift;
    seen.show(count);
  }

  dispose(): void {
    this.drop();
  }
}
