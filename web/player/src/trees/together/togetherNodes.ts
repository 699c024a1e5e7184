/** Pass 1 of a species with one call per step: all its levels of detail, each on rows of its own (nodes/nodePass.ts draws each apart). */
import {
  type DataTexture,
  GLSL3,
  Mesh,
  OrthographicCamera,
  RawShaderMaterial,
  type RenderTarget,
  type WebGLRenderTarget,
} from "three";
import type { Easing } from "../../core/motion/easedPoses";
import type { DrawnMotion, NodeLevel } from "../../core/table/drawnTable";
import type { DrawList } from "../drawList";
import { roomFor } from "../instanceData";
import { FLAT_SHIFT, flatTexture } from "../nodes/flatTexture";
import { uintTarget } from "../nodes/glslNodes";
import { gatherPoses, PERIODS, type PoseRows, writeLinks } from "../nodes/levelPass";
import { COVER_GLSL } from "../nodes/levelShader";
import type { NodeRenderer } from "../nodes/nodeGraphics";
import { type LevelRows, levelRows, nodeLayout } from "../nodes/nodeLayout";
import { fullScreenTriangle } from "../nodes/nodePass";
import type { LevelTexels, TreeNodes } from "../nodes/treeNodes";
import { DISPLACE_ALL_GLSL, SHORTEN_ALL_GLSL } from "./togetherNodeShader";

/** Values of all levels one after the other, as a texture of four channels. */
function joined(levels: readonly NodeLevel[], rowsOf: (level: NodeLevel) => Float32Array): DataTexture {
  const { texture, data } = flatTexture(
    levels.reduce((sum, level) => sum + rowsOf(level).length / 4, 0),
    4,
  );
  let to = 0;
  for (const level of levels) {
    data.set(rowsOf(level), to);
    to += rowsOf(level).length;
  }
  return texture;
}

/** The links of all levels, whose nodes are numbered one level after the other. */
function joinedLinks(levels: readonly NodeLevel[]): DataTexture {
  const { texture, data } = flatTexture(
    levels.reduce((sum, { nodes }) => sum + nodes, 0),
    4,
  );
  let first = 0;
  for (const level of levels) {
    writeLinks(level, data, first);
    first += level.nodes;
  }
  return texture;
}

/** Marks runs of texels of a four-channel flat texture for upload, in whole rows; each is a first texel and an end. */
function uploadRows(texture: DataTexture, runs: readonly (readonly [number, number])[]): void {
  const width = 2 ** FLAT_SHIFT;
  const rows = new Set<number>();
  for (const [from, end] of runs)
    for (let row = Math.floor(from / width); row < Math.ceil(end / width); row++) rows.add(row);
  texture.clearUpdateRanges();
  for (const row of [...rows].sort((a, b) => a - b)) texture.addUpdateRange(row * width * 4, width * 4);
  texture.needsUpdate = true;
}

/** Poses of the drawn trees: each level's from its own texel on. */
class Poses {
  flat = flatTexture(0, 4);
  private readonly written = new Set<number>();

  makeRoom(texels: number): void {
    this.flat.texture.dispose();
    this.flat = flatTexture(texels, 4);
  }

  /** Marks a level for the next upload; `rangesOf`: its texels. */
  mark(level: number, rangeOf: (level: number) => readonly [number, number]): void {
    this.written.add(level);
    uploadRows(
      this.flat.texture,
      [...this.written].map((one) => rangeOf(one)),
    );
  }

  uploaded(): void {
    this.written.clear();
  }
}

export class TogetherNodes implements TreeNodes {
  readonly target: RenderTarget = uintTarget(1, 1);
  private readonly first: RenderTarget = uintTarget(1, 1);
  shift: number;
  private readonly levels: readonly NodeLevel[];
  private readonly newest = new Poses();
  private readonly before = new Poses();
  private readonly textures: readonly DataTexture[];
  private readonly geometry = fullScreenTriangle();
  private readonly camera = new OrthographicCamera();
  private readonly displacing: Mesh;
  private readonly shortening: Mesh;
  private readonly materials: readonly RawShaderMaterial[];
  /** Frames since each level's last pose update. */
  private readonly ages: Uint8Array;
  /** First texel of each level in the poses, and their room. */
  private readonly posesFrom: Int32Array;
  private room = 0;
  private places: readonly LevelRows[] = [];
  private readonly uniforms;
  private list: DrawList | null = null;
  private poses: Float32Array | null = null;
  private easing: Easing | null = null;

  /** `factor`: shared factor of all displacements. */
  constructor(
    private readonly motion: DrawnMotion,
    private readonly maxSide: number,
    factor: { readonly value: number },
  ) {
    const { levels } = motion;
    this.levels = levels;
    const layout = nodeLayout(0, levels.length, maxSide);
    this.shift = layout.shift;
    this.resize(layout.width, layout.height);
    this.ages = new Uint8Array(levels.length);
    this.posesFrom = new Int32Array(levels.length);
    this.textures = [
      joined(levels, (level) => level.basis),
      joined(levels, (level) => level.turn),
      joinedLinks(levels),
    ];
    const [basis, turn, links] = this.textures;
    this.uniforms = {
      uPoses: { value: this.newest.flat.texture },
      uBefore: { value: this.before.flat.texture },
      uFactor: factor,
      uShift: { value: this.shift },
      uSizes: { value: this.sizes() },
      uPlaces: { value: new Int32Array(4 * levels.length) },
      uShares: { value: new Float32Array(levels.length).fill(1) },
    };
    const displacing = this.material(DISPLACE_ALL_GLSL, { uRows: { value: basis } });
    const shortening = this.material(SHORTEN_ALL_GLSL, {
      uRows: { value: turn },
      uMoved: { value: this.first.texture },
      uLinks: { value: links },
    });
    this.materials = [displacing, shortening];
    [this.displacing, this.shortening] = [displacing, shortening].map((material) => {
      const mesh = new Mesh(this.geometry, material);
      mesh.frustumCulled = false;
      return mesh;
    });
  }

  private material(fragmentShader: string, own: RawShaderMaterial["uniforms"]): RawShaderMaterial {
    return new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: COVER_GLSL,
      fragmentShader,
      depthTest: false,
      depthWrite: false,
      uniforms: { ...this.uniforms, ...own },
    });
  }

  /** Per level: nodes, quads of coordinates, channel of the wind in the last one, and nodes of the levels before. */
  private sizes(): Int32Array {
    let before = 0;
    return Int32Array.from(
      this.levels.flatMap(({ nodes, quads, coordinates }) => {
        const sizes = [nodes, quads, coordinates.length % 4, before];
        before += nodes;
        return sizes;
      }),
    );
  }

  private resize(width: number, height: number): void {
    this.target.setSize(width, height);
    this.first.setSize(width, height);
  }

  /** Ensures capacity for the trees drawn in this frame, with a margin while the camera moves. */
  private makeRoom(trees: readonly number[]): void {
    const texels = this.levels.reduce((sum, { nodes }, k) => sum + nodes * trees[k], 0);
    const rows = Math.ceil(texels / this.target.width) + this.levels.length;
    if (rows <= this.target.height) return;
    const layout = nodeLayout(1.3 * texels, this.levels.length, this.maxSide);
    this.shift = layout.shift;
    this.resize(layout.width, layout.height);
  }

  place(list: DrawList): readonly LevelTexels[] {
    const trees = this.levels.map((_, k) => list.visible[k] + list.hidden[k]);
    this.makeRoom(trees);
    const { width, height } = this.target;
    const layout = { width, height, shift: this.shift };
    const nodes = this.levels.map((level) => level.nodes);
    this.places = levelRows(layout, nodes, trees);
    this.list = list;
    this.placePoses();
    this.restart();
    return this.places.map(({ row, trees: fitting }, k) => ({
      first: row * width,
      trees: fitting,
      nodes: nodes[k],
    }));
  }

  private placePoses(): void {
    const { uniforms, newest, before } = this;
    const rowsOfLevels = uniforms.uSizes.value;
    let texels = 0;
    let rows = 0;
    for (const [k, { quads, nodes }] of this.levels.entries()) {
      const { row, trees } = this.places[k];
      this.posesFrom[k] = texels;
      uniforms.uPlaces.value.set([row, trees, texels, rows], 4 * k);
      texels += trees * quads;
      rows += 3 * nodes * rowsOfLevels[4 * k + 1];
    }
    if (texels > this.room) {
      this.room = roomFor(texels);
      newest.makeRoom(this.room);
      before.makeRoom(this.room);
    }
    uniforms.uShift.value = this.shift;
    uniforms.uPoses.value = newest.flat.texture;
    uniforms.uBefore.value = before.flat.texture;
  }

  private readonly rangeOf = (level: number): readonly [number, number] => {
    const from = this.posesFrom[level];
    return [from, from + this.places[level].trees * this.levels[level].quads];
  };

  private get rows(): PoseRows | null {
    const { poses, easing, list, motion } = this;
    if (!poses || !list || poses.length < list.share.length * motion.stride) return null;
    const { order, start } = list;
    return { poses, easing, stride: motion.stride, wind: motion.modes, order, start };
  }

  /** Takes the newest poses of all drawn trees at once, because other trees are drawn. */
  private restart(): void {
    const { rows } = this;
    if (!rows) return;
    for (const [k] of this.levels.entries()) {
      this.gather(k, rows);
      this.ages[k] = PERIODS[k] - 1;
      this.uniforms.uShares.value[k] = 1;
    }
  }

  setPoses(poses: Float32Array, easing: Easing | null): void {
    const first = this.poses === null;
    this.poses = poses;
    this.easing = easing;
    if (first) this.restart();
    else this.advance();
  }

  /** Takes the poses of the levels that are due, and interpolates those of the others. */
  private advance(): void {
    const { rows, ages, newest, before, rangeOf } = this;
    if (!rows) return;
    for (const [k] of this.levels.entries()) {
      const period = PERIODS[k];
      ages[k] = (ages[k] + 1) % period;
      if (ages[k] === 0) {
        if (period > 1 && this.places[k].trees > 0) {
          const [from, end] = rangeOf(k);
          before.flat.data.set(newest.flat.data.subarray(4 * from, 4 * end), 4 * from);
          before.mark(k, rangeOf);
        }
        this.gather(k, rows);
      }
      this.uniforms.uShares.value[k] = (ages[k] + 1) / period;
    }
  }

  private gather(level: number, rows: PoseRows): void {
    const { trees } = this.places[level];
    if (trees === 0) return;
    gatherPoses(rows, this.levels[level], level, trees, this.newest.flat.data, 4 * this.posesFrom[level]);
    this.newest.mark(level, this.rangeOf);
  }

  render(renderer: NodeRenderer): void {
    const rows = this.places.reduce((most, place) => Math.max(most, place.row + place.rows), 0);
    if (rows === 0) return;
    const before = renderer.getRenderTarget();
    const { autoClear } = renderer;
    renderer.autoClear = false; // every texel that is read is drawn
    for (const [target, mesh] of [
      [this.first, this.displacing],
      [this.target, this.shortening],
    ] as const) {
      target.viewport.set(0, 0, target.width, rows);
      renderer.setRenderTarget(target as WebGLRenderTarget);
      renderer.render(mesh, this.camera);
    }
    renderer.autoClear = autoClear;
    renderer.setRenderTarget(before);
    this.newest.uploaded();
    this.before.uploaded();
  }

  dispose(): void {
    this.target.dispose();
    this.first.dispose();
    this.geometry.dispose();
    for (const material of this.materials) material.dispose();
    for (const texture of [...this.textures, this.newest.flat.texture, this.before.flat.texture])
      texture.dispose();
  }
}
