/** Tree picking: a ring around the picked tree, its figures, and a camera that can follow it. */

import type { TreeAt } from "galewood/client";
import { tipDisplacement_m, tipNode } from "galewood/motion";
import { groundUnder, INSTANCE_FLOATS, type Ray } from "galewood/trees";
import { Raycaster, Vector2, Vector3 } from "three";
import type { Forest, MovingGroup, PickedTree } from "../scene/forest";
import { groundHeight_m } from "../scene/ground/landscape";
import { PickRing } from "../scene/overlays/pickRing";
import type { Stage } from "../scene/stage";
import type { ForestClient } from "./forestClient";

/** Current figures of the picked tree. */
export interface PickedFigures extends PickedTree {
  readonly moves: boolean;
  readonly tip_m: number;
  /** Sway and pressure relative to the sampled maximum: above 1 the tree is beyond the sampled range. */
  readonly extrapolationRatio: number | null;
  /** Last record found by the paper's state search; null with the modal method or on the server. */
  readonly record: number | null;
}

/** Pointer movement below which a press counts as a click. */
const CLICK_PX = 6;
/** A tree is hidden if the ground is hit this much nearer. */
const HIDDEN_M = 3;
const RING_SHARE = 0.55;
const AIM_SHARE = 0.6;
/** Time (s) in which the camera covers three quarters of the distance to the tree. */
const FOLLOW_S = 0.35;

export class TreePicker {
  /** Whether the camera keeps the picked tree in the middle. */
  following = false;
  /** Whether a press may select; asked at the press, because what it was for may be over at the release. */
  enabled: () => boolean = () => true;
  /** Called with the place of a click on open ground. */
  onGround: (x_m: number, z_m: number) => void = () => {};
  private picked: PickedTree | null = null;
  private at: TreeAt | null = null;
  private shown: readonly MovingGroup[] = [];
  private pressed: { x: number; y: number } | null = null;
  private readonly ring = new PickRing();
  private readonly aim = new Vector3();

  /** `changed` is called with the picked tree, or with null when the selection ends. */
  constructor(
    private readonly stage: Stage,
    private readonly forest: Forest,
    private readonly client: ForestClient,
    private readonly changed: (picked: PickedTree | null) => void = () => {},
  ) {
    stage.scene.add(this.ring.mesh);
    this.canvas.addEventListener("pointerdown", this.press);
    this.canvas.addEventListener("pointerup", this.release);
    this.canvas.addEventListener("keydown", this.key);
  }

  private get canvas(): HTMLCanvasElement {
    return this.stage.renderer.domElement;
  }

  private readonly press = (event: PointerEvent): void => {
    const meant = event.isPrimary && event.button === 0 && this.enabled();
    this.pressed = meant ? { x: event.clientX, y: event.clientY } : null;
  };

  private readonly release = (event: PointerEvent): void => {
    const { pressed } = this;
    this.pressed = null;
    if (!pressed || !event.isPrimary) return;
    if (Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > CLICK_PX) return;
    const picked = this.find(event.clientX, event.clientY);
    this.select(picked);
    const ground = picked ? null : groundUnder(this.ray(event.clientX, event.clientY), groundHeight_m);
    if (ground) this.onGround(ground.x, ground.z);
  };

  private readonly key = (event: KeyboardEvent): void => {
    if (event.key === "Escape") this.select(null);
  };

  private ray(left_px: number, top_px: number): Ray {
    const box = this.canvas.getBoundingClientRect();
    const caster = new Raycaster();
    const x = (2 * (left_px - box.left)) / box.width - 1;
    const y = 1 - (2 * (top_px - box.top)) / box.height;
    caster.setFromCamera(new Vector2(x, y), this.stage.camera);
    return { from: caster.ray.origin, to: caster.ray.direction };
  }

  /** The tree at a position in the window (px); null if there is none. */
  find(left_px: number, top_px: number): PickedTree | null {
    const ray = this.ray(left_px, top_px);
    const hit = this.forest.pick(ray, this.client.poses);
    if (!hit) return null;
    const ground = groundUnder(ray, groundHeight_m);
    if (ground) {
      const { x, z } = ray.from;
      const ground_m = Math.hypot(ground.x - x, ground.z - z) / Math.hypot(ray.to.x, ray.to.z);
      if (ground_m < hit.distance_m - HIDDEN_M) return null;
    }
    return hit;
  }

  /** Selects a tree; null clears the selection. */
  select(picked: PickedTree | null): void {
    this.picked = picked;
    this.shown = [];
    if (!picked) {
      this.following = false;
      this.at = null;
      this.client.watch(null);
      this.ring.hide();
    } else this.locate(picked);
    this.changed(picked);
  }

  /** The picked tree. */
  get selected(): PickedTree | null {
    return this.picked;
  }

  /** Group and index of the picked tree; null if there is none or it is static. */
  get moving(): TreeAt | null {
    return this.at;
  }

  get figures(): PickedFigures | null {
    if (!this.picked) return null;
    const { extrapolationRatio = null, record = null } = (this.at && this.client.watched) || {};
    return { ...this.picked, moves: this.at !== null, tip_m: this.tip_m, extrapolationRatio, record };
  }

  /** Tip displacement of the picked tree. */
  get tip_m(): number {
    const { at, client, shown } = this;
    const motion = at && shown[at.group]?.forest.motion;
    const poses = at && client.poses[at.group];
    if (!at || !motion || !poses) return 0;
    const pose = poses.subarray(at.tree * motion.stride, (at.tree + 1) * motion.stride);
    return tipDisplacement_m(motion, tipNode(motion), pose, this.data(at)[6]);
  }

  private data({ group, tree }: TreeAt): Float32Array {
    const { data } = this.shown[group].forest.instances;
    return data.subarray(tree * INSTANCE_FLOATS, (tree + 1) * INSTANCE_FLOATS);
  }

  /** Per frame: finds the tree again after a new placement, and moves the camera. */
  advance(dt_s: number): void {
    if (!this.picked) return;
    if (this.shown !== this.forest.moving) this.locate(this.picked);
    if (this.following) this.follow(dt_s);
  }

  private locate(picked: PickedTree): void {
    this.shown = this.forest.moving;
    if (!this.forest.has(picked)) {
      this.select(null);
      return;
    }
    const group = this.shown.findIndex(({ asset }) => asset.id === picked.treeId);
    const tree = group < 0 ? -1 : this.shown[group].forest.instances.ids.indexOf(picked.id);
    this.at = tree < 0 ? null : { group, tree };
    this.client.watch(this.at);
    const { x, z } = picked.position;
    this.ring.show(x, z, Math.max(0.9, RING_SHARE * picked.radius_m));
  }

  /** Moves the camera and its target smoothly towards the crown. */
  private follow(dt_s: number): void {
    const { picked, stage, aim } = this;
    if (!picked) return;
    const { x, y, z } = picked.position;
    aim.set(x, y + AIM_SHARE * picked.height_m, z);
    const part = 1 - 0.25 ** (dt_s / FOLLOW_S);
    aim.sub(stage.controls.target).multiplyScalar(part);
    stage.controls.target.add(aim);
    stage.camera.position.add(aim);
  }

  dispose(): void {
    this.canvas.removeEventListener("pointerdown", this.press);
    this.canvas.removeEventListener("pointerup", this.release);
    this.canvas.removeEventListener("keydown", this.key);
    this.ring.dispose();
  }
}
