/** Tree picking: a ring around the picked tree, its figures, and a camera that can follow it. */

import { signal } from "@preact/signals-core";
import type { TreeAt } from "galewood/client";
import { Vector3 } from "three";
import type { MovingGroup, PickedTree } from "../../scene/forest";
import { PickRing } from "../../scene/overlays/pickRing";
import type { Frame } from "../forest/frameLoop";
import type { World } from "../forest/world";
import type { Store } from "../store/store";
import { isClick } from "../ui/dom";

/** Current figures of the picked tree. */
export interface PickedFigures extends PickedTree {
  readonly moves: boolean;
  readonly tip_m: number;
  /** Sway and pressure relative to the sampled maximum: above 1 the tree is beyond the sampled range. */
  readonly extrapolationRatio: number | null;
  /** Last record found by the paper's state search; null with the modal method or on the server. */
  readonly record: number | null;
}

const RING_SHARE = 0.55;
const AIM_SHARE = 0.6;
/** Time (s) in which the camera covers three quarters of the distance to the tree. */
const FOLLOW_S = 0.35;

export class TreePicker {
  /** Whether the camera keeps the picked tree in the middle. */
  readonly following = signal(false);
  /** Called with the place of a click on open ground. */
  onGround: (x_m: number, z_m: number) => void = () => {};
  private readonly picked = signal<PickedTree | null>(null);
  private at: TreeAt | null = null;
  private shown: readonly MovingGroup[] = [];
  private pressed: { x: number; y: number } | null = null;
  private readonly ring = new PickRing();
  private readonly aim = new Vector3();

  constructor(
    private readonly store: Store,
    private readonly world: World,
  ) {
    const { canvas } = world;
    world.stage.scene.add(this.ring.mesh);
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("keydown", ({ key }) => {
      if (key === "Escape") this.select(null);
    });
  }

  /** What a click is for is asked at the press, because it may be over at the release. */
  private press(event: PointerEvent): void {
    const meant = event.isPrimary && event.button === 0 && !this.store.state.placing;
    this.pressed = meant ? { x: event.clientX, y: event.clientY } : null;
  }

  private release(event: PointerEvent): void {
    const { pressed } = this;
    this.pressed = null;
    if (!pressed || !event.isPrimary || !isClick(pressed, event)) return;
    const picked = this.world.pick(event.clientX, event.clientY);
    this.select(picked);
    const ground = picked ? null : this.world.groundAt(event.clientX, event.clientY);
    if (ground) this.onGround(ground.x, ground.z);
  }

  /** Selects a tree; null clears the selection. */
  select(picked: PickedTree | null): void {
    this.shown = [];
    if (!picked) {
      this.following.value = false;
      this.at = null;
      this.world.client.watch(null);
      this.ring.hide();
    } else if (!this.locate(picked)) return;
    this.picked.value = picked;
  }

  /** The picked tree, a signal: whoever reads it in an effect follows it. */
  get selected(): PickedTree | null {
    return this.picked.value;
  }

  /** Group and index of the picked tree; null if there is none or it is static. */
  get moving(): TreeAt | null {
    return this.at;
  }

  get figures(): PickedFigures | null {
    const { selected, at, world } = this;
    if (!selected) return null;
    const { extrapolationRatio = null, record = null } = (at && world.client.watched) || {};
    const tip_m = at ? world.tip_m(at) : 0;
    return { ...selected, moves: at !== null, tip_m, extrapolationRatio, record };
  }

  /** Finds the tree again after a new placement, and moves the camera. */
  advance({ played_s }: Frame): void {
    const { selected } = this;
    if (!selected) return;
    if (this.shown !== this.world.forest.moving) this.locate(selected);
    if (this.following.value) this.follow(selected, played_s);
  }

  /** Finds a tree in the placement that is shown; returns whether it still exists. The selection ends if it does not. */
  private locate(picked: PickedTree): boolean {
    const { forest, client } = this.world;
    if (!forest.has(picked)) {
      this.select(null);
      return false;
    }
    this.shown = forest.moving;
    const group = this.shown.findIndex(({ asset }) => asset.id === picked.treeId);
    const tree = group < 0 ? -1 : this.shown[group].forest.instances.ids.indexOf(picked.id);
    this.at = tree < 0 ? null : { group, tree };
    client.watch(this.at);
    const { x, z } = picked.position;
    this.ring.show(x, z, Math.max(0.9, RING_SHARE * picked.radius_m));
    return true;
  }

  /** Moves the camera and its target smoothly towards the crown. */
  private follow({ position: { x, y, z }, height_m }: PickedTree, dt_s: number): void {
    const { aim } = this;
    const { camera, controls } = this.world.stage;
    aim.set(x, y + AIM_SHARE * height_m, z);
    const part = 1 - 0.25 ** (dt_s / FOLLOW_S);
    aim.sub(controls.target).multiplyScalar(part);
    controls.target.add(aim);
    camera.position.add(aim);
  }
}
