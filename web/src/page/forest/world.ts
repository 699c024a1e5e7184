/** The forest on the screen: its scene, its trees and the worker that moves them, as the settings want them. */

import { effect, signal } from "@preact/signals-core";
import type { TreeAt } from "galewood/client";
import { tipDisplacement_m, tipNode } from "galewood/motion";
import { groundUnder, INSTANCE_FLOATS, type Ray } from "galewood/trees";
import { meanVelocity_m_s, WindField } from "galewood/wind";
import { Raycaster, Vector2 } from "three";
import type { Planted } from "../../scene/background/farWood";
import { viewerAt } from "../../scene/camera/sight";
import { exaggeration } from "../../scene/exaggeration";
import { Forest, type PickedTree, type PlacedSpecies } from "../../scene/forest";
import { groundHeight_m } from "../../scene/ground/landscape";
import type { Quality } from "../../scene/quality";
import { Stage } from "../../scene/stage";
import { StandIns } from "../../scene/treeSurface/standIns";
import { showExaggeration } from "../controls/exaggerated";
import { showPulls } from "../pulling/showPulls";
import { loadPart, withServer } from "../server/connected";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { element } from "../ui/dom";
import { ContextLoss } from "./contextLoss";
import type { ForestClient } from "./forestClient";
import { speciesOptions } from "./speciesOptions";

/** A place above the ground, m. */
export interface AboveGround {
  readonly x: number;
  readonly above: number;
  readonly z: number;
}

/** How often trees are selected again at once until their triangles keep to the budget. */
const MOST_SELECTIONS = 4;
/** A tree is hidden if the ground is hit this much nearer. */
const HIDDEN_M = 3;

export class World {
  readonly stage: Stage;
  readonly forest: Forest;
  /** The wind field as the worker has it. */
  readonly field: WindField;
  /** Number of placements whose trees have appeared. */
  readonly placements = signal(0);
  private readonly graphics: ContextLoss;
  private readonly standIns: StandIns;
  /** Uniform of the leaf flutter: time, s, and whether leaves flutter. */
  private readonly flutter = { value: { x: 0, y: 0 } };
  /** Whether the trees to draw must be selected again, all at once. */
  private viewChanged = true;
  /** Turns of the trees that have not been selected since the camera moved last. */
  private turnsLeft = 0;
  /** Pictures since the triangles of the trees were compared with their budget. */
  private unweighed = 0;

  constructor(
    private readonly store: Store,
    readonly client: ForestClient,
  ) {
    const { settings, opened } = store;
    this.stage = new Stage(element<HTMLCanvasElement>("view"), settings.quality);
    const { stage } = this;
    this.field = new WindField(settings.wind);
    // three.js creates its own resources again when it draws; what depends on the view is selected again.
    this.graphics = new ContextLoss(this.canvas, () => this.showScenery());
    this.forest = new Forest(speciesOptions(settings.quality, stage, this.flutter), stage.backdrop.library);
    stage.scene.add(this.forest.group);
    if (opened.eye && opened.target) {
      stage.camera.position.set(...opened.eye);
      stage.controls.target.set(...opened.target);
    }
    if (opened.clouds) stage.sky.drift.set(...opened.clouds);
    this.follow();
    this.standIns = new StandIns(this.forest.options);
    // The driver compiles while the trees load.
    stage.warmUp(this.standIns.group);
  }

  /** Draws what the settings say from now on. */
  private follow(): void {
    const { settings } = this.store;
    const { stage, forest } = this;
    effect(() => this.showScenery());
    effect(() => this.exaggerate(settings.exaggeration));
    effect(() => {
      stage.backdrop.shown = settings.background;
    });
    effect(() => {
      this.flutter.value.y = settings.flutter ? 1 : 0;
    });
    effect(() => void this.occlude(settings.quality));
    watch(
      () => [settings.quality],
      ([quality]) => {
        stage.setQuality(quality);
        forest.options = speciesOptions(quality, stage, this.flutter);
      },
    );
  }

  /** Ambient occlusion is loaded when it is first wanted, which is at high quality. */
  private async occlude(quality: Quality): Promise<void> {
    this.stage.occlude(null);
    if (quality !== "high") return;
    await withServer("Contact shadows are missing.", async () => {
      const { AmbientOcclusion } = await loadPart(() => import("../../scene/ambientOcclusion"));
      if (this.store.settings.quality === quality) this.stage.occlude(AmbientOcclusion);
    });
  }

  /** Shows season and time of day in light, land and leaves. */
  private showScenery(): void {
    const { daytime, season } = this.store.settings;
    this.stage.show(daytime, season);
    this.forest.setSeason(season);
    this.stage.shelter(this.forest.crowns);
    this.viewChanged = true;
  }

  /** Sets the factor of all displacements on screen; figures stay as simulated. */
  private exaggerate(factor: number): void {
    exaggeration.value = factor;
    showExaggeration(factor);
    this.viewChanged = true;
  }

  get canvas(): HTMLCanvasElement {
    return this.stage.renderer.domElement;
  }

  /** Whether nobody can see a picture: the page is hidden, or its graphics context lost. */
  get isUnseen(): boolean {
    return document.visibilityState === "hidden" || this.graphics.lost;
  }

  get hasTrees(): boolean {
    return this.forest.group.children.length > 0;
  }

  /** Makes what a placement needs that is to be shown soon; the driver compiles it meanwhile. */
  prepare(placed: readonly PlacedSpecies[]): void {
    const { renderer, camera, scene } = this.stage;
    for (const group of this.forest.prepare(placed)) renderer.compile(group, camera, scene);
  }

  /** Shows a placement; `planted` describes it to the background forest. */
  show(placed: readonly PlacedSpecies[], planted: Planted): void {
    this.forest.show(placed);
    this.standIns.dispose();
    this.stage.surround(planted);
    this.stage.shelter(this.forest.crowns);
    this.viewChanged = true;
    this.placements.value++;
  }

  // ---- every frame --------------------------------------------------------------------------------

  /** Requests the next poses, dt_s on, and takes those that have arrived. */
  moveTrees(dt_s: number): void {
    if (!this.store.state.stopped) this.client.advance(dt_s, viewerAt(this.stage.camera));
    this.takePoses();
  }

  /** Waits for the requested poses, and takes them. */
  async settle(): Promise<void> {
    while (this.client.isBusy) await new Promise((done) => setTimeout(done, 1));
    this.takePoses();
  }

  private takePoses(): void {
    const { forest, client, field } = this;
    if (!client.takeFreshPoses()) return;
    for (const [k, moving] of forest.moving.entries())
      moving.forest.setPoses(client.eased[k].poses, client.eased[k]);
    showPulls(forest, client);
    if (client.wind) field.state = client.wind.state;
  }

  /** Moves sky, snow, ground cover and leaves on by dt_s. `more`: see Stage.advance. */
  moveScenery(dt_s: number, more: number): void {
    const { stage, client, field, flutter } = this;
    stage.advance(dt_s, meanVelocity_m_s(this.store.settings.wind), field, client.time_s, more);
    if (client.wind) stage.backdrop.wood.advance(client.wind.state, client.time_s);
    flutter.value.x += dt_s;
  }

  /** Draws the picture, `dt_s` after the last one, unless a waiting forest has nothing new; returns whether it did. */
  draw(dt_s: number, waits: boolean): boolean {
    const { stage, forest } = this;
    const moved = stage.updateCamera();
    if (waits && (this.hasTrees || !(moved || this.viewChanged))) return false;
    if (moved || this.viewChanged) stage.backdrop.select(stage.view());
    this.select(moved);
    stage.renderer.info.reset();
    forest.renderNodes(stage.renderer);
    stage.render(dt_s);
    return true;
  }

  private select(moved: boolean): void {
    const { forest, stage } = this;
    const { turns } = forest;
    if (this.viewChanged || (moved && turns === 1)) {
      this.selectAll();
      return;
    }
    if (moved) this.turnsLeft = turns;
    if (this.turnsLeft > 0) {
      this.turnsLeft--;
      forest.select(stage.view(), turns);
    }
    if (++this.unweighed < turns) return; // trees have been selected by different budgets
    this.unweighed = 0;
    if (stage.weigh(forest.triangles)) this.turnsLeft = turns;
  }

  /** All trees in one picture, a few times over if they have too many triangles. */
  private selectAll(): void {
    const { forest, stage } = this;
    this.viewChanged = false;
    this.turnsLeft = 0;
    forest.select(stage.view());
    for (let k = 0; k < MOST_SELECTIONS && stage.weigh(forest.triangles); k++) forest.select(stage.view());
  }

  // ---- places -------------------------------------------------------------------------------------

  /** Points a caster from the eye through a place in the window, px. */
  aim(left_px: number, top_px: number, caster = new Raycaster()): Ray {
    const box = this.canvas.getBoundingClientRect();
    const x = (2 * (left_px - box.left)) / box.width - 1;
    const y = 1 - (2 * (top_px - box.top)) / box.height;
    caster.setFromCamera(new Vector2(x, y), this.stage.camera);
    return { from: caster.ray.origin, to: caster.ray.direction };
  }

  /** The ground at a place in the window, px; null if there is none. */
  groundAt(left_px: number, top_px: number): { x: number; z: number } | null {
    return groundUnder(this.aim(left_px, top_px), groundHeight_m);
  }

  /** The tree at a place in the window, px; null if there is none. */
  pick(left_px: number, top_px: number): PickedTree | null {
    const ray = this.aim(left_px, top_px);
    const hit = this.forest.pick(ray, this.client.poses);
    const ground = hit && groundUnder(ray, groundHeight_m);
    if (!hit || !ground) return hit;
    const { x, z } = ray.from;
    const ground_m = Math.hypot(ground.x - x, ground.z - z) / Math.hypot(ray.to.x, ray.to.z);
    return ground_m < hit.distance_m - HIDDEN_M ? null : hit;
  }

  /** Tip displacement of a tree, m; 0 if it does not move. */
  tip_m({ group, tree }: TreeAt): number {
    const species = this.forest.moving[group]?.forest;
    const poses = this.client.poses[group];
    if (!species?.motion || !poses) return 0;
    const { motion, instances } = species;
    const pose = poses.subarray(tree * motion.stride, (tree + 1) * motion.stride);
    return tipDisplacement_m(motion, tipNode(motion), pose, instances.data[tree * INSTANCE_FLOATS + 6]);
  }

  /** Stops or resumes the clock of the forest, also for those who share it. */
  pause(paused: boolean): void {
    this.store.state.stopped = paused;
    this.client.pause(paused);
  }

  /** Moves the camera. */
  look(eye: AboveGround, at: AboveGround): void {
    const placed = ({ x, above, z }: AboveGround) => ({ x, y: groundHeight_m(x, z) + above, z });
    this.stage.cutTo(placed(eye), placed(at));
  }

  /** Stops the worker and frees the memory of the graphics card. */
  dispose(): void {
    this.stage.renderer.setAnimationLoop(null);
    this.client.dispose();
    this.forest.clear();
    this.stage.dispose();
  }
}
