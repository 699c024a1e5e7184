/** Gust fronts that this visitor sends by clicking the ground, and the bands that show all of them. */
import { FrontBands } from "../../scene/overlays/frontBands";
import type { World } from "../forest/world";
import type { TreePicker } from "../picking/treePicker";

/** The server accepts about as many. */
const EVERY_MS = 1500;

export class Gusts {
  private readonly bands = new FrontBands();
  private sent_ms = Number.NEGATIVE_INFINITY;

  constructor(
    private readonly world: World,
    picker: TreePicker,
  ) {
    world.stage.scene.add(this.bands.group);
    picker.onGround = (x_m, z_m) => this.send(x_m, z_m);
  }

  /** Sends a front from a place; too many in a row are ignored. */
  private send(x_m: number, z_m: number): void {
    const now_ms = performance.now();
    if (now_ms - this.sent_ms < EVERY_MS) return;
    this.sent_ms = now_ms;
    this.world.client.gust(x_m, z_m);
  }

  advance(): void {
    const { wind, time_s } = this.world.client;
    this.bands.show(wind?.state.fronts ?? [], time_s);
  }
}
