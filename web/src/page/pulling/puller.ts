/**
 * Pulling trees with the mouse, a finger or the keyboard. A press on a near tree, or on the selected one, followed by
 * a drag pulls the branch that was hit; elsewhere a drag turns the view. A finger must press long on a tree that is
 * not selected. With a tree selected, P takes hold of it, and the arrow keys move the hand.
 */

import { tipNode } from "galewood/motion";
import type { Ray } from "galewood/trees";
import { Plane, Raycaster, Vector3 } from "three";
import type { PickedTree } from "../../scene/forest";
import { PullHandle } from "../../scene/overlays/pullHandle";
import type { World } from "../forest/world";
import type { TreePicker } from "../picking/treePicker";
import type { Store } from "../store/store";
import { grabbedVertex, vertexAt } from "./grabPoint";
import { grabbedTree, HeldTree, treeAt } from "./pulledTree";
import { PullTag, pullInWords } from "./pullTag";

/** Trees up to this distance can be pulled without being selected. */
const NEAR_M = 16;
/** Pointer movement from which a press is a drag. */
const DRAG_PX = 6;
const LONG_PRESS_MS = 400;
const HOVER_EVERY_MS = 120;
/** A press this many pixels beside a branch takes hold of it. */
const BESIDE_PX = 12;
/** Path of the hand per key press, relative to the distance from the eye. */
const KEY_SHARE = 0.012;

const KEYS: Readonly<Record<string, readonly [number, number, number]>> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, -1],
  PageDown: [0, 0, 1],
};
const HELP_TEXT = "Arrow keys move the point, Page Up and Page Down push and pull it, Enter releases it.";

interface Press {
  readonly pointer: number;
  readonly x: number;
  readonly y: number;
  readonly tree: HeldTree;
  readonly timer: ReturnType<typeof setTimeout> | null;
}

interface Pull {
  readonly tree: HeldTree;
  readonly by: "pointer" | "keys";
  readonly start: Vector3;
  /** Where the hand is. */
  readonly hand: Vector3;
  /** From the grabbed point to where the pointer took hold. */
  readonly offset: Vector3;
}

export class Puller {
  private press: Press | null = null;
  private pull: Pull | null = null;
  private hovered_ms = 0;
  private readonly handle = new PullHandle();
  private readonly tag: PullTag;
  private readonly caster = new Raycaster();
  private readonly plane = new Plane();
  private readonly canvas: HTMLCanvasElement;

  constructor(
    private readonly store: Store,
    private readonly world: World,
    private readonly picker: TreePicker,
  ) {
    this.canvas = world.canvas;
    this.tag = new PullTag(this.canvas);
    world.stage.scene.add(this.handle.group);
    // before the camera's controls and the picker hear of it
    const options = { capture: true };
    this.canvas.addEventListener("pointerdown", (event) => this.pressed(event), options);
    this.canvas.addEventListener("pointermove", (event) => this.moved(event), options);
    this.canvas.addEventListener("pointerup", (event) => this.lifted(event), options);
    this.canvas.addEventListener("pointercancel", (event) => this.lifted(event), options);
    this.canvas.addEventListener("lostpointercapture", (event) => this.lifted(event), options);
    this.canvas.addEventListener("keydown", (event) => this.key(event), options);
    this.canvas.addEventListener("blur", () => this.pull?.by === "keys" && this.release(), options);
  }

  /** Where the held point is shown in the window, px, and the hand; null while nothing is pulled. */
  get figures() {
    const point = this.pull?.tree.point;
    if (!this.pull || !point) return null;
    const { tree, start, hand } = this.pull;
    return {
      ...tree.grip,
      start_px: this.project(start),
      point_px: this.project(point),
      hand_px: this.project(hand),
      moved_m: point.distanceTo(start),
      force_N: tree.force_N,
    };
  }

  /** A forest that stands still cannot be pulled. */
  private get enabled(): boolean {
    const { state, playback } = this.store;
    return !state.placing && !state.stopped && !playback.paused;
  }

  // ---- mouse and finger ---------------------------------------------------------------------------

  private pressed(event: PointerEvent): void {
    if (this.pull) this.release();
    const plain = !(event.ctrlKey || event.shiftKey || event.metaKey || event.altKey);
    if (!this.enabled || !event.isPrimary || event.button !== 0 || !plain) return;
    const picked = this.world.pick(event.clientX, event.clientY);
    if (!picked || !this.isNear(picked)) return;
    const tree = this.grab(picked, event.clientX, event.clientY);
    if (!tree) return;
    const waits = event.pointerType === "touch" && !this.isSelected(picked);
    const timer = waits ? setTimeout(() => this.begin(), LONG_PRESS_MS) : null;
    this.press = { pointer: event.pointerId, x: event.clientX, y: event.clientY, tree, timer };
    if (!waits) this.world.stage.controls.enabled = false;
  }

  private moved(event: PointerEvent): void {
    const { press, pull } = this;
    if (!press) {
      this.hover(event);
      return;
    }
    if (event.pointerId !== press.pointer) return;
    const dragged = Math.hypot(event.clientX - press.x, event.clientY - press.y) > DRAG_PX;
    if (!pull && dragged) {
      if (press.timer === null) this.begin();
      else this.end(); // a finger that moves at once turns the view
    }
    if (this.pull?.by === "pointer") this.moveHand(event.clientX, event.clientY);
  }

  private lifted(event: PointerEvent): void {
    if (event.pointerId === this.press?.pointer) this.end();
  }

  private begin(): void {
    const { press } = this;
    const point = press?.tree.point;
    if (!press || !point) return;
    this.world.stage.controls.enabled = false;
    this.canvas.setPointerCapture(press.pointer);
    this.canvas.style.cursor = "grabbing";
    this.start(press.tree, "pointer", point);
    this.plane.setFromNormalAndCoplanarPoint(this.viewing, point);
    this.aim(press.x, press.y);
    const held = this.caster.ray.intersectPlane(this.plane, new Vector3());
    if (held) this.pull?.offset.subVectors(held, point);
  }

  /** Moves the hand to the pointer, on the plane through the grabbed point that faces the camera. */
  private moveHand(left_px: number, top_px: number): void {
    this.aim(left_px, top_px);
    const { pull } = this;
    if (pull && this.caster.ray.intersectPlane(this.plane, pull.hand)) pull.hand.sub(pull.offset);
  }

  /** Ends a press, and the pull that it has become. */
  private end(): void {
    const { press } = this;
    if (press?.timer) clearTimeout(press.timer);
    this.press = null;
    this.world.stage.controls.enabled = true;
    this.canvas.style.cursor = "";
    if (this.pull?.by === "pointer") this.release();
  }

  /** The cursor becomes a hand above what can be pulled. */
  private hover(event: PointerEvent): void {
    const now_ms = performance.now();
    if (event.pointerType !== "mouse" || event.buttons !== 0 || now_ms - this.hovered_ms < HOVER_EVERY_MS)
      return;
    this.hovered_ms = now_ms;
    const picked = this.enabled ? this.world.pick(event.clientX, event.clientY) : null;
    const near = picked && this.isNear(picked);
    this.canvas.style.cursor = near && this.grab(picked, event.clientX, event.clientY) ? "grab" : "";
  }

  private isNear(picked: PickedTree): boolean {
    return picked.distance_m <= NEAR_M || this.isSelected(picked);
  }

  private isSelected({ treeId, id }: PickedTree): boolean {
    const { selected } = this.picker;
    return selected?.treeId === treeId && selected.id === id;
  }

  private grab(picked: PickedTree, left_px: number, top_px: number): HeldTree | null {
    const at = treeAt(this.world.forest.moving, picked);
    const tree = at && grabbedTree(this.world, at);
    if (!tree) return null;
    const ray = this.aim(left_px, top_px);
    const { fov } = this.world.stage.camera;
    const slope = (BESIDE_PX * 2 * Math.tan((fov * Math.PI) / 360)) / Math.max(1, this.canvas.clientHeight);
    const vertex = grabbedVertex(tree, ray, slope);
    const { treeId, id } = picked;
    return vertex === null ? null : new HeldTree(this.world, { treeId, id, vertex });
  }

  // ---- keyboard -----------------------------------------------------------------------------------

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.pull?.by === "keys") this.pullKey(event);
    else if (event.key === "p" || event.key === "P") {
      event.stopImmediatePropagation();
      this.takeHold();
    }
  }

  private pullKey(event: KeyboardEvent): void {
    const way = KEYS[event.key];
    if (way) this.moveByKey(way, event.shiftKey ? 3 : 1);
    else if (["Enter", "Escape", "p", "P"].includes(event.key)) {
      this.release();
      this.tag.announce("Released. The tree swings.");
    } else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  /** Takes hold of the tip of the selected tree. */
  private takeHold(): void {
    const { selected } = this.picker;
    const at = selected && treeAt(this.world.forest.moving, selected);
    const tree = at && grabbedTree(this.world, at);
    if (!selected || !tree) this.tag.announce("Select a tree first, then press P to pull it.");
    else if (!this.enabled) this.tag.announce("The forest is paused. Resume it to pull a tree.");
    else {
      const vertex = vertexAt(tree.motion, tipNode(tree.motion));
      const { treeId, id } = selected;
      const held = new HeldTree(this.world, { treeId, id, vertex });
      const { point } = held;
      if (!point) return;
      this.start(held, "keys", point);
      this.tag.announce(`Holding the tip of the tree. ${HELP_TEXT}`);
    }
  }

  private moveByKey([right, up, back]: readonly [number, number, number], times: number): void {
    const { pull } = this;
    if (!pull) return;
    const { camera } = this.world.stage;
    const step = new Vector3(right, up, back).applyQuaternion(camera.quaternion);
    pull.hand.addScaledVector(step, times * KEY_SHARE * pull.hand.distanceTo(camera.position));
  }

  // ---- both ---------------------------------------------------------------------------------------

  private start(tree: HeldTree, by: Pull["by"], point: Vector3): void {
    this.pull = { tree, by, start: point.clone(), hand: point.clone(), offset: new Vector3() };
  }

  private release(): void {
    this.pull?.tree.release();
    this.pull = null;
    this.handle.hide();
    this.tag.hide();
  }

  /** Per frame: moves the hand's target, and shows the handle. */
  advance(): void {
    const { pull } = this;
    if (!pull) return;
    const point = pull.tree.point;
    if (!point || !this.enabled) {
      this.end();
      this.release();
      return;
    }
    pull.tree.pullTo(pull.hand);
    this.handle.show(point, pull.hand, this.world.stage.camera.position);
    const { x, y } = this.project(pull.hand);
    const box = this.canvas.getBoundingClientRect();
    const words = pullInWords(point.distanceTo(pull.start), pull.tree.force_N);
    this.tag.show(x - box.left, y - box.top, words);
  }

  private get viewing(): Vector3 {
    return this.world.stage.camera.getWorldDirection(new Vector3());
  }

  private aim(left_px: number, top_px: number): Ray {
    return this.world.aim(left_px, top_px, this.caster);
  }

  /** A place in the world, in the window, px. */
  private project(place: Vector3): { x: number; y: number } {
    const box = this.canvas.getBoundingClientRect();
    const seen = place.clone().project(this.world.stage.camera);
    return {
      x: box.left + (0.5 + 0.5 * seen.x) * box.width,
      y: box.top + (0.5 - 0.5 * seen.y) * box.height,
    };
  }
}
