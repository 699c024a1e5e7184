/** Marks a tree whose motion is being computed: a soft ring on the ground and a small label. */
import { type PerspectiveCamera, Vector3 } from "three";
import { GrowthRing } from "../../scene/overlays/growthRing";
import type { Stage } from "../../scene/stage";
import { element, make } from "../ui/dom";

const RING_SHARE = 0.6;
const LEAST_RING_M = 0.9;
/** Height of the label above the ground. */
const LABEL_M = 0.4;

export interface Marked {
  readonly position: { readonly x: number; readonly y: number; readonly z: number };
  readonly radius_m: number;
}

export class TreeMark {
  private readonly ring = new GrowthRing();
  // The card of the tree says the same to screen readers.
  private readonly label = make("div", "", "tree-label");
  private readonly at = new Vector3();
  private readonly canvas: HTMLCanvasElement;
  private readonly camera: PerspectiveCamera;

  constructor(stage: Stage) {
    this.canvas = stage.renderer.domElement;
    this.camera = stage.camera;
    this.label.setAttribute("aria-hidden", "true");
    stage.scene.add(this.ring.mesh);
    element("stage").append(this.label);
  }

  show({ position, radius_m }: Marked, words: string, fraction: number): void {
    const { x, y, z } = position;
    this.ring.show(x, z, Math.max(LEAST_RING_M, RING_SHARE * radius_m), fraction);
    this.at.set(x, y + LABEL_M, z);
    this.label.textContent = words;
    this.advance();
  }

  /** Per frame: keeps the label at the tree. */
  advance(): void {
    const { x, y, z } = this.at.clone().project(this.camera);
    const { clientWidth, clientHeight } = this.canvas;
    const seen = z < 1 && Math.abs(x) < 1 && Math.abs(y) < 1;
    this.label.style.visibility = seen ? "visible" : "hidden";
    const [left, top] = [((x + 1) / 2) * clientWidth, ((1 - y) / 2) * clientHeight];
    this.label.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px) translateX(-50%)`;
  }

  dispose(): void {
    this.ring.dispose();
    this.label.remove();
  }
}
