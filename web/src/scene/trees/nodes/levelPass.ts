/** One level of pass 1: its own nodes and modes, drawn to its own rows, updated at a rate that depends on its distance. */
import { type BufferGeometry, type DataTexture, GLSL3, Mesh, RawShaderMaterial } from "three";
import type { NodeLevel } from "../../../worker/protocol";
import { FLAT_SHIFT, flatTexture, uploadFirst } from "./flatTexture";
import type { LevelRows } from "./nodeLayout";

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
#ifdef BLEND
uniform sampler2D uBefore;
uniform float uShare;
#endif
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
    #ifdef BLEND
      vec4 before = flat_(uBefore, slot * QUADS + k);
      q = before + (q - before) * uShare;
    #endif
    moved.x += dot(q, flat_(uBasis, row + k));
    moved.y += dot(q, flat_(uBasis, row + QUADS + k));
    moved.z += dot(q, flat_(uBasis, row + 2 * QUADS + k));
  }
  node = vec4(moved, q[WIND_CHANNEL]);
}
`;

/** Poses as written by the worker, `stride` floats per tree, and the list of drawn trees. */
export interface PoseRows {
  readonly poses: Float32Array;
  readonly stride: number;
  /** Index of the wind in a row. */
  readonly wind: number;
  readonly order: Uint32Array;
  /** First index of each level in the order. */
  readonly start: Uint32Array;
}

/** Frames between pose updates, by level; poses are interpolated in between. */
const PERIODS = [1, 1, 1, 2, 4];

/** One level: its basis, the poses of its drawn trees, and the mesh that draws them. */
export class LevelPass {
  readonly mesh: Mesh<BufferGeometry, RawShaderMaterial>;
  private readonly basis: DataTexture;
  private readonly period: number;
  private poses;
  private before;
  /** Frames since the last pose update. */
  private age = 0;
  rows: LevelRows = { row: 0, rows: 0, trees: 0 };

  constructor(
    readonly level: NodeLevel,
    trees: number,
    geometry: BufferGeometry,
    private readonly index: number,
  ) {
    this.period = PERIODS[index] ?? 1;
    const { texture, data } = flatTexture(level.basis.length / 4, 4);
    data.set(level.basis);
    this.basis = texture;
    this.poses = flatTexture(trees * level.quads, 4);
    this.before = this.period > 1 ? flatTexture(trees * level.quads, 4) : this.poses;
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
      defines: {
        QUADS: this.level.quads,
        FLAT_SHIFT,
        WIND_CHANNEL: this.level.columns.length % 4,
        ...(this.period > 1 && { BLEND: 1 }),
      },
      uniforms: {
        uBasis: { value: this.basis },
        uPoses: { value: this.poses.texture },
        uBefore: { value: this.before.texture },
        uShare: { value: 1 },
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

  /** Call when the drawn trees have changed: takes their newest poses immediately. */
  restart(from: PoseRows): void {
    this.gather(from);
    this.age = this.period - 1;
    this.mesh.material.uniforms.uShare.value = 1;
  }

  /** Per frame: takes new poses if they are due, otherwise interpolates. */
  advance(from: PoseRows): void {
    this.age = (this.age + 1) % this.period;
    if (this.age === 0) {
      [this.poses, this.before] = [this.before, this.poses];
      this.gather(from);
    }
    this.mesh.material.uniforms.uShare.value = (this.age + 1) / this.period;
  }

  /** Copies the modes of the level and the wind of each drawn tree. */
  private gather({ poses, stride, wind, order, start }: PoseRows): void {
    const { columns, quads } = this.level;
    const { data, texture } = this.poses;
    const first = start[this.index];
    let to = 0;
    for (let slot = first; slot < first + this.rows.trees; slot++, to += 4 * quads) {
      const from = order[slot] * stride;
      for (let k = 0; k < columns.length; k++) data[to + k] = poses[from + columns[k]];
      data[to + columns.length] = poses[from + wind];
    }
    uploadFirst(texture, this.rows.trees * quads);
    const { uniforms } = this.mesh.material;
    uniforms.uPoses.value = texture;
    uniforms.uBefore.value = this.before.texture;
  }

  dispose(): void {
    this.mesh.material.dispose();
    this.basis.dispose();
    this.poses.texture.dispose();
    this.before.texture.dispose();
  }
}
