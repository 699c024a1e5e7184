/**
 * Pass 1: displacement and rotation of every node of every drawn tree, and the wind: one texel per node and tree
 * (nodeTexel.ts). Each level of detail has its own nodes and modes and is drawn to its own rows.
 */
import {
  BufferAttribute,
  BufferGeometry,
  OrthographicCamera,
  type RenderTarget,
  type WebGLRenderTarget,
} from "three";
import type { Easing } from "../../core/motion/easedPoses";
import type { DrawnMotion } from "../../core/table/drawnTable";
import type { DrawList } from "../drawList";
import { LevelPass, type PoseRows } from "./levelPass";
import type { NodeRenderer, TreeGraphics } from "./nodeGraphics";
import { levelRows, nodeLayout } from "./nodeLayout";
import type { LevelTexels, TreeNodes } from "./treeNodes";

function fullScreenTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  return geometry;
}

export class NodePass implements TreeNodes {
  readonly target: RenderTarget;
  /** Displacements before the links are shortened. */
  private readonly first: RenderTarget;
  readonly shift = { value: 0 };
  private readonly levels: LevelPass[];
  private readonly triangle = fullScreenTriangle();
  private readonly camera = new OrthographicCamera();
  private list: DrawList | null = null;
  private poses: Float32Array | null = null;
  private easing: Easing | null = null;

  constructor(
    private readonly motion: DrawnMotion,
    graphics: TreeGraphics,
    private readonly maxSide: number,
    factor: { value: number },
  ) {
    const layout = nodeLayout(0, motion.levels.length, maxSide);
    this.shift.value = layout.shift;
    this.target = graphics.target(layout.width, layout.height, true);
    this.first = graphics.target(layout.width, layout.height, false);
    const { texture } = this.first;
    this.levels = motion.levels.map(
      (level, k) => new LevelPass(level, this.triangle, k, graphics, factor, texture),
    );
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
    this.shift.value = layout.shift;
    this.target.setSize(layout.width, layout.height);
    this.first.setSize(layout.width, layout.height);
  }

  place(list: DrawList, told: (texels: readonly LevelTexels[]) => void): void {
    this.makeRoom(list);
    const { width, height } = this.target;
    const counts = this.levels.map((_, k) => list.visible[k] + list.hidden[k]);
    const layout = { width, height, shift: this.shift.value };
    const places = levelRows(
      layout,
      this.motion.levels.map(({ nodes }) => nodes),
      counts,
    );
    places.forEach((rows, k) => {
      this.levels[k].place(rows, this.shift.value);
    });
    this.list = list;
    this.eachLevel((level, rows) => level.restart(rows));
    told(
      places.map(({ row, trees }, k) => ({ first: row * width, trees, nodes: this.levels[k].level.nodes })),
    );
  }

  setPoses(poses: Float32Array, easing: Easing | null): void {
    const first = this.poses === null;
    this.poses = poses;
    this.easing = easing;
    this.eachLevel((level, rows) => (first ? level.restart(rows) : level.advance(rows)));
  }

  private eachLevel(act: (level: LevelPass, rows: PoseRows) => void): void {
    const { poses, easing, list, motion } = this;
    if (!poses || !list || poses.length < list.share.length * motion.stride) return;
    const { order, start } = list;
    const rows = { poses, easing, stride: motion.stride, wind: motion.modes, order, start };
    for (const level of this.levels) if (level.rows.trees > 0) act(level, rows);
  }

  render(renderer: NodeRenderer): void {
    if (this.levels.every(({ rows }) => rows.trees === 0)) return;
    const before = renderer.getRenderTarget();
    const { autoClear } = renderer;
    renderer.autoClear = false; // every texel that is read is drawn, and each level draws to its own rows
    this.step(renderer, this.first, (level) => level.displacing);
    this.step(renderer, this.target, (level) => level.shortening);
    renderer.autoClear = autoClear;
    renderer.setRenderTarget(before);
  }

  private step(
    renderer: NodeRenderer,
    target: RenderTarget,
    meshOf: (level: LevelPass) => LevelPass["displacing"],
  ): void {
    for (const level of this.levels) {
      const { rows } = level;
      if (rows.trees === 0) continue;
      target.viewport.set(0, rows.row, target.width, rows.rows);
      renderer.setRenderTarget(target as WebGLRenderTarget); // or a target of WebGPURenderer, for that
      renderer.render(meshOf(level), this.camera);
    }
  }

  dispose(): void {
    this.target.dispose();
    this.first.dispose();
    this.triangle.dispose();
    for (const level of this.levels) level.dispose();
  }
}
