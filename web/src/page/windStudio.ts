/** Connects the wind instruments to the scene: overlay, mast, picking, and the wind field that they display. */

import type { TreeAt } from "galewood/client";
import { nearestTree, tipDisplacement_m, tipNode } from "galewood/motion";
import { groundUnder } from "galewood/trees";
import { type WindDocument, WindField } from "galewood/wind";
import { Raycaster, Vector2, Vector3 } from "three";
import type { Forest } from "../scene/forest";
import { groundHeight_m } from "../scene/ground/landscape";
import { Mast } from "../scene/overlays/mast";
import { WindOverlay } from "../scene/overlays/windOverlay";
import type { Stage } from "../scene/stage";
import type { ForestClient } from "./forestClient";
import { element } from "./ui/dom";
import { dialTurn_deg } from "./ui/instruments/dial";
import { type CurrentWind, Instruments } from "./ui/instruments/instruments";

export interface StudioEvents {
  wind(wind: WindDocument): void;
  problem(title: string, hint: string): void;
}

/** Pointer movement below which a press counts as a click. */
const CLICK_PX = 6;
const COVERAGE_EVERY_MS = 500;

export class WindStudio {
  readonly field: WindField;
  private readonly overlay = new WindOverlay();
  private readonly mast = new Mast();
  private readonly instruments: Instruments;
  private readonly forward = new Vector3();
  private placing = false;
  private pressed: { x: number; y: number } | null = null;
  private time_s = 0;
  private shownCoverage_ms = 0;
  coverage = 1;
  /** The selected tree, whose tip is shown instead of that of the nearest tree. */
  tipOf: TreeAt | null = null;

  constructor(
    private readonly stage: Stage,
    current: CurrentWind,
    events: StudioEvents,
  ) {
    this.field = new WindField(current.wind);
    this.instruments = new Instruments(current, {
      wind: events.wind,
      overlay: (visible) => {
        this.overlay.visible = visible;
      },
      placing: (active) => this.setPlacing(active),
      anemometerRemoved: () => this.mast.hide(),
      problem: events.problem,
    });
    stage.scene.add(this.overlay.mesh, this.mast.group);
    this.canvas.addEventListener("pointerdown", this.press);
    this.canvas.addEventListener("pointerup", this.release);
  }

  private get canvas(): HTMLCanvasElement {
    return this.stage.renderer.domElement;
  }

  /** Plays the measurement of a file. */
  async loadMeasurement(file: File): Promise<void> {
    await this.instruments.loadMeasurement(file);
  }

  async loadWind(file: File): Promise<void> {
    await this.instruments.loadWind(file);
  }

  /** Shows the page's wind after a change. */
  showWind(): void {
    this.instruments.showWind();
  }

  /** Whether a click on the ground places the anemometer. */
  get isPlacing(): boolean {
    return this.placing;
  }

  private setPlacing(active: boolean): void {
    this.placing = active;
    this.canvas.style.cursor = active ? "crosshair" : "";
    // On a phone the instruments cover the ground that has to be tapped.
    if (active && matchMedia("(max-width: 760px)").matches) element("instruments-toggle").click();
  }

  private readonly press = (event: PointerEvent): void => {
    this.pressed = { x: event.clientX, y: event.clientY };
  };

  private readonly release = (event: PointerEvent): void => {
    const { pressed } = this;
    if (!this.placing || !pressed) return;
    if (Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > CLICK_PX) return;
    const place = this.groundAt(event.clientX, event.clientY);
    if (place) this.placeAnemometer(place.x, place.z);
  };

  private groundAt(left_px: number, top_px: number): { x: number; z: number } | null {
    const box = this.canvas.getBoundingClientRect();
    const x = (2 * (left_px - box.left)) / box.width - 1;
    const y = 1 - (2 * (top_px - box.top)) / box.height;
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(x, y), this.stage.camera);
    return groundUnder({ from: caster.ray.origin, to: caster.ray.direction }, groundHeight_m);
  }

  placeAnemometer(x: number, z: number): void {
    this.setPlacing(false);
    this.instruments.anemometerPlaced();
    this.mast.place(x, z);
    this.instruments.anemometer.placeAt(x, z, this.field, this.time_s);
  }

  get anemometer(): { x: number; z: number; speed_m_s: number; samples: number; tip_m: number } | null {
    const { place, speed_m_s, recorder } = this.instruments.anemometer;
    if (!place) return null;
    return { ...place, speed_m_s, samples: recorder.count, tip_m: recorder.tip_m[recorder.count - 1] || 0 };
  }

  /** Per frame: copies the state and time of the worker's wind field, and updates the display. */
  advance(dt_s: number, client: ForestClient, forest: Forest): void {
    const now_ms = performance.now();
    if (client.wind) {
      this.field.state = client.wind.state;
      this.coverage = client.wind.coverage;
    }
    this.time_s = client.time_s;
    this.overlay.update(this.field, this.time_s, this.stage.controls.target);
    this.stage.camera.getWorldDirection(this.forward);
    const tip_m = this.tip_m(client, forest);
    this.instruments.advance(dialTurn_deg(this.forward), this.field, this.time_s, tip_m, now_ms);
    this.mast.turn(this.instruments.anemometer.speed_m_s, dt_s);
    if (now_ms - this.shownCoverage_ms > COVERAGE_EVERY_MS) {
      this.shownCoverage_ms = now_ms;
      this.instruments.showCoverage(this.coverage);
    }
  }

  /** Tip displacement of the selected tree, or of the tree nearest to the anemometer. */
  private tip_m(client: ForestClient, forest: Forest): number {
    const { place } = this.instruments.anemometer;
    if (!place) return 0;
    const placements = forest.moving.map(({ forest: { instances } }) => instances.placement);
    const found = this.tipOf ?? nearestTree(placements, place.x, place.z);
    if (!found) return 0;
    const { motion } = forest.moving[found.group].forest;
    const poses = client.poses[found.group];
    if (!motion || !poses) return 0;
    const pose = poses.subarray(found.tree * motion.stride, (found.tree + 1) * motion.stride);
    return tipDisplacement_m(motion, tipNode(motion), pose, placements[found.group][4 * found.tree + 3]);
  }

  dispose(): void {
    this.canvas.removeEventListener("pointerdown", this.press);
    this.canvas.removeEventListener("pointerup", this.release);
    this.instruments.dispose();
    this.overlay.dispose();
    this.mast.dispose();
  }
}
