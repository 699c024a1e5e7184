/** Gust fronts that this visitor sends by clicking the ground, and the bands that show all of them. */
import { FrontBands } from "../../scene/overlays/frontBands";
import type { Stage } from "../../scene/stage";
import type { ForestClient } from "../forestClient";

/** The server accepts about as many. */
const EVERY_MS = 1500;

export class Gusts {
  private readonly bands = new FrontBands();
  private sent_ms = Number.NEGATIVE_INFINITY;

  constructor(
    stage: Stage,
    private readonly client: ForestClient,
  ) {
    stage.scene.add(this.bands.group);
  }

  /** Sends a front from a place; too many in a row are ignored. */
  send(x_m: number, z_m: number): void {
    const now_ms = performance.now();
    if (now_ms - this.sent_ms < EVERY_MS) return;
    this.sent_ms = now_ms;
    this.client.gust(x_m, z_m);
  }

  /** Per frame. */
  advance(): void {
    this.bands.show(this.client.wind?.state.fronts ?? [], this.client.time_s);
  }

  dispose(): void {
    this.bands.dispose();
  }
}
