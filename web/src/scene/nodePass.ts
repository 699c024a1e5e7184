/**
 * Pass 1: where every node of every drawn tree is now. One texel per node and tree: xyz in m, w = wind in m/s.
 * Each level of detail has nodes and modes of its own and is drawn on rows of its own.
 */
import {
  BufferAttribute,
  BufferGeometry,
  Camera,
  type DataTexture,
  GLSL3,
  HalfFloatType,
  Mesh,
  NearestFilter,
  RawShaderMaterial,
  RGBAFormat,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { type LevelRows, levelRows, nodeLayout } from "../nodeLayout";
import type { NodeLevel, TableMotion } from "../worker/protocol";
import type { DrawList } from "./drawList";
import { FLAT_SHIFT, flatTexture, uploadFirst } from "./flatTexture";

const vertexShader = /* glsl */ `
in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }
`;

const fragmentShader = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D uBasis;
uniform sampler2D uPoses;
uniform int uNodeCount;
uniform int uShift;
uniform int uRow;
uniform int uDrawn;
out vec4 node;

vec4 flat_(sampler2D source, int i) {
  return texelFetch(source, ivec2(i & ((1 << FLAT_SHIFT) - 1), i >> FLAT_SHIFT), 0);
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int i = ((texel.y - uRow) << uShift) + texel.x;
  int slot = i / uNodeCount;
  if (slot >= uDrawn) discard;
  int row = (i - slot * uNodeCount) * 3 * QUADS;
  vec4 q;
  vec3 moved = vec3(0.0);
  for (int k = 0; k < QUADS; k++) {
    q = flat_(uPoses, slot * QUADS + k);
    moved.x += dot(q, flat_(uBasis, row + k));
    moved.y += dot(q, flat_(uBasis, row + QUADS + k));
    moved.z += dot(q, flat_(uBasis, row + 2 * QUADS + k));
  }
  node = vec4(moved, q[WIND_CHANNEL]);
}
`;

function fullScreenTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  return geometry;
}

/** One level: its basis, the poses of its drawn trees, and the mesh that draws them. */
class LevelPass {
  readonly mesh: Mesh<BufferGeometry, RawShaderMaterial>;
  private readonly basis: DataTexture;
  private readonly poses;
  rows: LevelRows = { row: 0, rows: 0, trees: 0 };

  constructor(
    readonly level: NodeLevel,
    trees: number,
    geometry: BufferGeometry,
  ) {
    const { texture, data } = flatTexture(level.basis.length / 4, 4);
    data.set(level.basis);
    this.basis = texture;
    this.poses = flatTexture(trees * level.quads, 4);
    this.mesh = new Mesh(geometry, this.material());
    this.mesh.frustumCulled = false;
  }

  private material(): RawShaderMaterial {
    return new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      depthTest: false,
      depthWrite: false,
      defines: { QUADS: this.level.quads, FLAT_SHIFT, WIND_CHANNEL: this.level.modes % 4 },
      uniforms: {
        uBasis: { value: this.basis },
        uPoses: { value: this.poses.texture },
        uNodeCount: { value: this.level.nodes },
        uShift: { value: 0 },
        uRow: { value: 0 },
        uDrawn: { value: 0 },
      },
    });
  }

  place(rows: LevelRows, shift: number): void {
    this.rows = rows;
    const { uniforms } = this.mesh.material;
    uniforms.uShift.value = shift;
    uniforms.uRow.value = rows.row;
    uniforms.uDrawn.value = rows.trees;
  }

  /** Copies the first modes and the wind of each drawn tree from rows of `stride` floats. */
  gather(poses: Float32Array, stride: number, wind: number, order: Uint32Array, start: number): void {
    const { modes, quads } = this.level;
    const { data, texture } = this.poses;
    let to = 0;
    for (let slot = start; slot < start + this.rows.trees; slot++, to += 4 * quads) {
      const from = order[slot] * stride;
      for (let k = 0; k < modes; k++) data[to + k] = poses[from + k];
      data[to + modes] = poses[from + wind];
    }
    uploadFirst(texture, this.rows.trees * quads);
  }

  dispose(): void {
    this.mesh.material.dispose();
    this.basis.dispose();
    this.poses.texture.dispose();
  }
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
    this.levels = motion.levels.map((level) => new LevelPass(level, trees, this.triangle));
  }

  /** Room for this frame's drawn trees, with some to spare while the camera moves. */
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

  /** Gives every tree of the list its texels; returns per level the first texel and the number of trees with room. */
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
    this.gather();
    return places.map(({ row, trees }, k) => ({
      first: row * width,
      trees,
      nodes: this.levels[k].level.nodes,
    }));
  }

  /** The newest poses: `stride` floats per tree, as the worker wrote them. */
  setPoses(poses: Float32Array): void {
    this.poses = poses;
    this.gather();
  }

  private gather(): void {
    const { poses, list, motion } = this;
    if (!poses || !list || poses.length < this.trees * motion.stride) return;
    for (const [k, level] of this.levels.entries()) {
      if (level.rows.trees > 0) level.gather(poses, motion.stride, motion.modes, list.order, list.start[k]);
    }
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
