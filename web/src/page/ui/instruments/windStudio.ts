/** Connects the wind instruments to the scene: overlay, mast, picking, and the wind field that they display. */

import { nearestTree } from "galewood/motion";
import { Vector3 } from "three";
import { Mast } from "../../../scene/overlays/mast";
import { WindOverlay } from "../../../scene/overlays/windOverlay";
import type { DataFiles } from "../../files/dataFiles";
import type { Frame } from "../../forest/frameLoop";
import type { World } from "../../forest/world";
import type { TreePicker } from "../../picking/treePicker";
import type { Store } from "../../store/store";
import { element, isClick, PHONE_PAGE } from "../dom";
import { dialTurn_deg } from "./dial";
import { Instruments } from "./instruments";

const COVERAGE_EVERY_MS = 500;

export class WindStudio {
  readonly instruments: Instruments;
  private readonly overlay = new WindOverlay();
  private readonly mast = new Mast();
  private readonly forward = new Vector3();
  private pressed: { x: number; y: number } | null = null;
  private shownCoverage_ms = 0;

  constructor(
    private readonly store: Store,
    private readonly world: World,
    private readonly picker: TreePicker,
    files: Pick<DataFiles, "takeWind">,
  ) {
    const { stage, canvas } = world;
    this.instruments = new Instruments(store.settings, {
      overlay: (visible) => {
        this.overlay.visible = visible;
      },
      placing: (active) => this.setPlacing(active),
      anemometerRemoved: () => this.mast.hide(),
      file: (file) => void files.takeWind(file),
    });
    stage.scene.add(this.overlay.mesh, this.mast.group);
    canvas.addEventListener("pointerdown", (event) => {
      this.pressed = { x: event.clientX, y: event.clientY };
    });
    canvas.addEventListener("pointerup", (event) => this.release(event));
  }

  private setPlacing(active: boolean): void {
    this.store.state.placing = active;
    this.world.canvas.style.cursor = active ? "crosshair" : "";
    // On a phone the instruments cover the ground that has to be tapped.
    if (active && matchMedia(PHONE_PAGE).matches) element("instruments-toggle").click();
  }

  private release(event: PointerEvent): void {
    const { pressed } = this;
    if (!this.store.state.placing || !pressed || !isClick(pressed, event)) return;
    const place = this.world.groundAt(event.clientX, event.clientY);
    if (place) this.placeAnemometer(place.x, place.z);
  }

  private placeAnemometer(x: number, z: number): void {
    this.setPlacing(false);
    this.instruments.anemometerPlaced();
    this.mast.place(x, z);
    this.instruments.anemometer.placeAt(x, z, this.world.field, this.world.client.time_s);
  }

  get anemometer(): { x: number; z: number; speed_m_s: number; samples: number; tip_m: number } | null {
    const { place, speed_m_s, recorder } = this.instruments.anemometer;
    if (!place) return null;
    return { ...place, speed_m_s, samples: recorder.count, tip_m: recorder.tip_m[recorder.count - 1] || 0 };
  }

  /** Share of the trees within the sampled range of winds, 0..1. */
  get coverage(): number {
    return this.world.client.wind?.coverage ?? 1;
  }

  advance({ played_s }: Frame): void {
    const { field, client, stage } = this.world;
    const now_ms = performance.now();
    this.overlay.update(field, client.time_s, stage.controls.target);
    stage.camera.getWorldDirection(this.forward);
    this.instruments.turn(dialTurn_deg(this.forward));
    const { anemometer } = this.instruments;
    anemometer.measure(field, client.time_s, this.tip_m);
    anemometer.draw(now_ms);
    this.mast.turn(anemometer.speed_m_s, played_s);
    if (now_ms - this.shownCoverage_ms > COVERAGE_EVERY_MS) {
      this.shownCoverage_ms = now_ms;
      this.instruments.showCoverage(this.coverage);
    }
  }

  /** Tip displacement of the selected tree, or of the tree nearest to the anemometer. */
  private get tip_m(): number {
    const { place } = this.instruments.anemometer;
    if (!place) return 0;
    const placements = this.world.forest.moving.map(({ forest: { instances } }) => instances.placement);
    const found = this.picker.moving ?? nearestTree(placements, place.x, place.z);
    return found ? this.world.tip_m(found) : 0;
  }
}
