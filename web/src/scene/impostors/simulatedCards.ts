/** Impostors of the simulated trees of one species, from some distance on. */
import type { Object3D, Texture } from "three";
import type { FarCards } from "../trees/farCards";
import type { TreeModel } from "../trees/mesh/treeMesh";
import type { Atlas } from "./atlas";
import { Cards } from "./cards";

/** The part of the library that is needed here. */
export interface AtlasSource {
  readonly from_m: number;
  arriving: boolean;
  atlasOf(model: TreeModel): Atlas | null;
}

/** When an atlas is complete, impostors begin out here and come nearer, so that no tree changes at once. */
const ARRIVAL = { from_m: 420, time_ms: 1500 };

export class SimulatedCards implements FarCards {
  private cards: Cards | null = null;
  private since_ms = 0;

  constructor(
    private readonly library: AtlasSource,
    private readonly model: TreeModel,
    private readonly group: Object3D,
    /** Height of the middle node relative to the tip. */
    private readonly middleAt: number,
  ) {}

  get from_m(): number {
    const atlas = this.library.atlasOf(this.model);
    if (!atlas) {
      // Not disposed of: after a loss of the graphics context the same atlas is baked again.
      this.cards?.seen.show(0);
      return Number.POSITIVE_INFINITY;
    }
    if (this.cards?.atlas !== atlas) this.take(atlas);
    const way = Math.min(1, (performance.now() - this.since_ms) / ARRIVAL.time_ms);
    if (way < 1) this.library.arriving = true;
    return ARRIVAL.from_m + (this.library.from_m - ARRIVAL.from_m) * way;
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

  reserve(count: number): { data: Float32Array; bend: Float32Array } {
    const list = this.cards?.seen;
    if (!list) throw new Error("no impostors");
    list.reserve(count);
    return list;
  }

  show(count: number, nodes: Texture, shift: number): void {
    if (!this.cards) return;
    this.cards.uniforms.uNodes.value = nodes;
    this.cards.uniforms.uNodeShift.value = shift;
    this.cards.seen.show(count);
  }

  dispose(): void {
    this.drop();
  }
}
