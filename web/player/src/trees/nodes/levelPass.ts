/** One level of pass 1: its own nodes and modes, drawn to its own rows, updated at a rate that depends on its distance. */
import { type BufferGeometry, type DataTexture, type Material, Mesh, type Texture } from "three";
import type { Easing } from "../../core/motion/easedPoses";
import type { NodeLevel } from "../../core/table/drawnTable";
import { roomFor } from "../instanceData";
import { flatTexture, uploadFirst } from "./flatTexture";
import type { LevelUniforms, TreeGraphics } from "./nodeGraphics";
import type { LevelRows } from "./nodeLayout";

/** Poses as written by the worker, `stride` floats per tree, and the list of drawn trees. */
export interface PoseRows {
  readonly poses: Float32Array;
  /** Of poses that are reached over several frames. */
  readonly easing: Easing | null;
  readonly stride: number;
  /** Index of the wind in a row. */
  readonly wind: number;
  readonly order: Uint32Array;
  /** First index of each level in the order. */
  readonly start: Uint32Array;
}

/** Copies the coordinates of a level and the wind of each of its drawn trees, from a float of the data on. */
export function gatherPoses(
  { poses, easing, stride, wind, order, start }: PoseRows,
  { coordinates, quads }: NodeLevel,
  index: number,
  trees: number,
  data: Float32Array,
  from: number,
): void {
  const first = start[index];
  const ease = easing?.easer(coordinates);
  let to = from;
  for (let slot = first; slot < first + trees; slot++, to += 4 * quads) {
    const tree = order[slot];
    const row = tree * stride;
    for (let k = 0; k < coordinates.length; k++) data[to + k] = poses[row + coordinates[k]];
    data[to + coordinates.length] = poses[row + wind];
    ease?.(tree, data, to);
  }
}

/** Frames between pose updates, by level; poses are interpolated in between. */
export const PERIODS = [1, 1, 1, 2, 4, 4];

type Step = Mesh<BufferGeometry, Material>;

/** A texture of rows [nodes, 3, 4 quads]. */
function rowsTexture(rows: Float32Array): DataTexture {
  const { texture, data } = flatTexture(rows.length / 4, 4);
  data.set(rows);
  return texture;
}

/** A texture of the links: vector at rest from the node before, and its index. */
function linksTexture(level: NodeLevel): DataTexture {
  const { texture, data } = flatTexture(level.nodes, 4);
  writeLinks(level, data, 0);
  return texture;
}

/** Writes the links of a level, whose nodes are numbered from `first` on. */
export function writeLinks({ nodes, rest_m, parent }: NodeLevel, data: Float32Array, first: number): void {
  for (let node = 0; node < nodes; node++) {
    const before = parent[node];
    for (let axis = 0; axis < 3; axis++)
      data[4 * (first + node) + axis] = rest_m[3 * node + axis] - rest_m[3 * before + axis];
    data[4 * (first + node) + 3] = first + before;
  }
}

/** One level: its rows, the poses of its drawn trees, and the meshes that draw both steps. */
export class LevelPass {
  /** Adds up displacements; its target is the second one's source. */
  readonly displacing: Step;
  readonly shortening: Step;
  private readonly textures: readonly DataTexture[];
  private readonly period: number;
  private poses = flatTexture(0, 4);
  private before = this.poses;
  /** Trees that the textures of poses can hold. */
  private room = 0;
  /** Frames since the last pose update. */
  private age = 0;
  rows: LevelRows = { row: 0, rows: 0, trees: 0 };
  private readonly uniforms: LevelUniforms;

  /** `factor`: shared factor of all displacements. `moved`: what the first step draws. */
  constructor(
    readonly level: NodeLevel,
    geometry: BufferGeometry,
    private readonly index: number,
    graphics: TreeGraphics,
    factor: { value: number },
    moved: Texture,
  ) {
    this.period = PERIODS[index] ?? 1;
    this.textures = [rowsTexture(level.basis), rowsTexture(level.turn), linksTexture(level)];
    const [basis, turn, links] = this.textures;
    const [displacing, shortening, uniforms] = graphics.steps(
      level,
      [basis, turn, links, this.poses.texture, moved],
      factor,
      this.period > 1,
    );
    this.displacing = new Mesh(geometry, displacing);
    this.shortening = new Mesh(geometry, shortening);
    for (const mesh of [this.displacing, this.shortening]) mesh.frustumCulled = false;
    this.uniforms = uniforms;
  }

  place(rows: LevelRows, shift: number): void {
    this.rows = rows;
    if (rows.trees > this.room) this.makeRoom(rows.trees);
    const { uniforms } = this;
    uniforms.uShift.value = shift;
    uniforms.uRow.value = rows.row;
    uniforms.uDrawn.value = rows.trees;
  }

  private makeRoom(trees: number): void {
    for (const { texture } of [this.poses, this.before]) texture.dispose();
    this.room = roomFor(trees);
    const texels = this.room * this.level.quads;
    this.poses = flatTexture(texels, 4);
    this.before = this.period > 1 ? flatTexture(texels, 4) : this.poses;
  }

  /** Call when the drawn trees have changed: takes their newest poses immediately. */
  restart(from: PoseRows): void {
    this.gather(from);
    this.age = this.period - 1;
    this.uniforms.uShare.value = 1;
  }

  /** Per frame: takes new poses if they are due, otherwise interpolates. */
  advance(from: PoseRows): void {
    this.age = (this.age + 1) % this.period;
    if (this.age === 0) {
      [this.poses, this.before] = [this.before, this.poses];
      this.gather(from);
    }
    this.uniforms.uShare.value = (this.age + 1) / this.period;
  }

  private gather(from: PoseRows): void {
    const { data, texture } = this.poses;
    gatherPoses(from, this.level, this.index, this.rows.trees, data, 0);
    uploadFirst(texture, this.rows.trees * this.level.quads);
    const { uniforms } = this;
    uniforms.uPoses.value = texture;
    uniforms.uBefore.value = this.before.texture;
  }

  dispose(): void {
    for (const mesh of [this.displacing, this.shortening]) mesh.material.dispose();
    for (const texture of this.textures) texture.dispose();
    this.poses.texture.dispose();
    this.before.texture.dispose();
  }
}
