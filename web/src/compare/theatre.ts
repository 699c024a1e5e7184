/** A small stage of its own: the tree by the table, and its ghost by the finite elements. */
import {
  AmbientLight,
  CircleGeometry,
  Color,
  DirectionalLight,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  Scene,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { TreeModel } from "../scene/treeMesh";
import type { TableMotion } from "../worker/protocol";
import { BentTree } from "./bentTree";
import { poseAt, type TableMethod, type Tracks } from "./tracks";

const BACKGROUND = 0x141c21;
const GROUND = 0x26302a;

/** What is shown of a comparison. */
export interface Shown {
  method: TableMethod;
  ghost: boolean;
  /** How many times as large the motion is drawn. */
  times: number;
  /** Error, as a share of the height, that is painted full red. */
  worst: number;
}

export class Theatre {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(34, 1, 0.05, 400);
  private readonly controls: OrbitControls;
  private readonly ground = new Mesh(new CircleGeometry(1, 64), new MeshBasicMaterial({ color: GROUND }));
  private solid: BentTree | null = null;
  private ghost: BentTree | null = null;
  private pose = new Float32Array(0);
  private readonly resized: ResizeObserver;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.scene.background = new Color(BACKGROUND);
    const sun = new DirectionalLight(0xfff0d8, 2.6);
    sun.position.set(3, 5, 2);
    this.ground.rotation.x = -Math.PI / 2;
    this.scene.add(new AmbientLight(0xbfd0dd, 1.1), sun, this.ground);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.resized = new ResizeObserver(() => this.resize(canvas));
    this.resized.observe(canvas);
  }

  /** Another tree takes the stage. */
  enter(model: TreeModel, motion: TableMotion): void {
    this.leave();
    this.solid = new BentTree(model, motion, false);
    this.ghost = new BentTree(model, motion, true);
    this.pose = new Float32Array(motion.modes);
    this.scene.add(this.solid.group, this.ghost.group);
    const reach_m = Math.max(model.height_m, 2 * model.radius_m);
    this.ground.scale.setScalar(0.6 * reach_m);
    this.controls.target.set(0, 0.5 * model.height_m, 0);
    this.camera.position.set(1.1 * reach_m, 0.62 * model.height_m, 1.55 * reach_m);
    this.controls.minDistance = 0.3 * reach_m;
    this.controls.maxDistance = 4 * reach_m;
  }

  /** Shows a moment of the comparison: `place` counts frames. */
  show(tracks: Tracks, place: number, { method, ghost, times, worst }: Shown): void {
    if (!this.solid || !this.ghost) return;
    poseAt(tracks.q[method], tracks.modes, place, this.pose);
    this.solid.nodes.bend(this.pose, times);
    poseAt(tracks.q.fem, tracks.modes, place, this.pose);
    this.ghost.nodes.bend(this.pose, times);
    this.solid.show();
    this.solid.paint(this.ghost.nodes, times * worst * tracks.height_m);
    this.ghost.group.visible = ghost;
    if (ghost) this.ghost.show();
  }

  render(): void {
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
  }

  private resize(canvas: HTMLCanvasElement): void {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  private leave(): void {
    for (const tree of [this.solid, this.ghost]) {
      if (!tree) continue;
      this.scene.remove(tree.group);
      tree.dispose();
    }
  }

  dispose(): void {
    this.resized.disconnect();
    this.leave();
    this.ground.geometry.dispose();
    this.ground.material.dispose();
    this.controls.dispose();
    this.renderer.dispose();
  }
}
