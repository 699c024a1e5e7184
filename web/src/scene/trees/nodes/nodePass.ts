/**
 * Pass 1: displacement of every node of every drawn tree. One texel per node and tree: xyz in m, w = wind in m/s.
 * Each level of detail has its own nodes and modes and is drawn to its own rows.
 */
import {
  BufferAttribute,
  BufferGeometry,
  Camera,
  HalfFloatType,
  NearestFilter,
  RGBAFormat,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { TableMotion } from "../../../worker/protocol";
import type { DrawList } from "../drawList";
import { LevelPass, type PoseRows } from "./levelPass";
import { levelRows, nodeLayout } from "./nodeLayout";

function fullScreenTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  return geometry;
}

export class NodePass {
  readonly target: WebGLRenderTarget;
  /** log2 of the target's width. */
  shift: number;
  private readonly levels: LevelPass[];
  private readonly triangle = fullScreenTriangle();
  private readonly camera = new Camera();
  private list: DrawList | null = null;
  private poses: Float32Array | null = null;

  constructor(
    private readonly motion: TableMotion,
    readonly trees: number,
    private readonly maxSide: number,
  ) {
    const layout = nodeLayout(0, motion.levels.length, maxSide);
    this.shift = layout.shift;
    this.target = new WebGLRenderTarget(layout.width, layout.height, {
      type: HalfFloatType,
      format: RGBAFormat,
      minFilter: NearestFilter,
      magFilter: NearestFilter,
      depthBuffer: false,
    });
    this.levels = motion.levels.map((level, k) => new LevelPass(level, trees, this.triangle, k));
  }

  /** Ensures capacity for the trees drawn in this frame, with a margin while the camera moves. */
  private makeRoom(list: DrawList): void {
    const texels = this.levels.reduce(
      (sum, { level }, k) => sum + level.nodes * (list.visible[k] + list.hidden[k]),
      0,
    );
    const rows = Math.ceil(texels / this.target.width) + this.levels.length;
    if (rows <= this.target.height) return;
    const layout = nodeLayout(1.3 * texels, this.levels.length, this.maxSide);
    this.shift = layout.shift;
    this.target.setSize(layout.width, layout.height);
  }

  /** Assigns texels to every tree of the list; returns the first texel and the number of trees that fit, per level. */
  place(list: DrawList): readonly { first: number; trees: number; nodes: number }[] {
    this.makeRoom(list);
    const { width, height } = this.target;
    const counts = this.levels.map((_, k) => list.visible[k] + list.hidden[k]);
    const layout = { width, height, shift: this.shift };
    const places = levelRows(
      layout,
      this.motion.levels.map(({ nodes }) => nodes),
      counts,
    );
    places.forEach((rows, k) => {
      this.levels[k].place(rows, this.shift);
    });
    this.list = list;
    this.eachLevel((level, rows) => level.restart(rows));
    return places.map(({ row, trees }, k) => ({
      first: row * width,
      trees,
      nodes: this.levels[k].level.nodes,
    }));
  }

  /** Sets the newest poses: `stride` floats per tree, as written by the worker. */
  setPoses(poses: Float32Array): void {
    const first = this.poses === null;
    this.poses = poses;
    this.eachLevel((level, rows) => (first ? level.restart(rows) : level.advance(rows)));
  }

  private eachLevel(act: (level: LevelPass, rows: PoseRows) => void): void {
    const { poses, list, motion } = this;
    if (!poses || !list || poses.length < list.share.length * motion.stride) return;
    const { order, start } = list;
    const rows = { poses, stride: motion.stride, wind: motion.modes, order, start };
    for (const level of this.levels) if (level.rows.trees > 0) act(level, rows);
  }

  render(renderer: WebGLRenderer): void {
    if (this.levels.every(({ rows }) => rows.trees === 0)) return;
    const before = renderer.getRenderTarget();
    for (const { rows, mesh } of this.levels) {
      if (rows.trees === 0) continue;
      this.target.viewport.set(0, rows.row, this.target.width, rows.rows);
      renderer.setRenderTarget(this.target);
      renderer.render(mesh, this.camera);
    }
    renderer.setRenderTarget(before);
  }

  dispose(): void {
    this.target.dispose();
    this.triangle.dispose();
    for (const level of this.levels) level.dispose();
  }
}
