/** The pulled trees of one species: uniforms, and a texture with the displacements of their vertices. */
import { type DataTexture, Vector3, Vector4 } from "three";
import { FLAT_SHIFT, flatTexture } from "../nodes/flatTexture";
import { MOST_PULLS } from "./pullShader";

/** A pull on a tree of this species; the force in the tree's frame at scale 1. */
export interface ShownPull {
  readonly x: number;
  readonly z: number;
  readonly force_N: readonly [number, number, number];
  /** [vertices, 3, 3] m per N, a column per force direction. */
  readonly field: Float32Array;
}

export interface PullUniforms {
  readonly uPulls: { value: number };
  readonly uPullPlace: { value: Vector4[] };
  readonly uPullForce: { value: Vector3[] };
  readonly uPullField: { value: DataTexture | null };
}

const TEXTURE_WIDTH = 2 ** FLAT_SHIFT;

export class PullSlots {
  readonly uniforms: PullUniforms = {
    uPulls: { value: 0 },
    uPullPlace: { value: Array.from({ length: MOST_PULLS }, () => new Vector4()) },
    uPullForce: { value: Array.from({ length: MOST_PULLS }, () => new Vector3()) },
    uPullField: { value: null },
  };
  private target: ReturnType<typeof flatTexture> | null = null;
  private readonly fields: (Float32Array | null)[] = new Array(MOST_PULLS).fill(null);
  private readonly rows: number;

  /** `holds`: of each vertex, the one whose displacement it takes. */
  constructor(private readonly holds: Uint32Array) {
    this.rows = Math.ceil((3 * holds.length) / TEXTURE_WIDTH);
  }

  /** Shows these pulls instead of the previous ones; only the first few are shown. */
  show(all: readonly ShownPull[]): void {
    const pulls = all.filter(({ field }) => field.length === 9 * this.holds.length).slice(0, MOST_PULLS);
    const { uPulls, uPullPlace, uPullForce } = this.uniforms;
    uPulls.value = pulls.length;
    for (const [k, { x, z, force_N, field }] of pulls.entries()) {
      const slot = this.slotOf(field, pulls);
      uPullPlace.value[k].set(x, z, slot * this.rows * TEXTURE_WIDTH, 0);
      uPullForce.value[k].set(...force_N);
    }
  }

  /** The slot that holds a field; a new one replaces a field that is not shown any more. */
  private slotOf(field: Float32Array, pulls: readonly ShownPull[]): number {
    const known = this.fields.indexOf(field);
    if (known >= 0) return known;
    const shown = new Set(pulls.map((pull) => pull.field));
    const slot = this.fields.findIndex((old) => old === null || !shown.has(old));
    this.fields[slot] = field;
    this.fill(slot, field);
    return slot;
  }

  private fill(slot: number, field: Float32Array): void {
    this.target ??= flatTexture(MOST_PULLS * this.rows * TEXTURE_WIDTH, 4);
    const { data, texture } = this.target;
    this.uniforms.uPullField.value = texture;
    const first = 4 * slot * this.rows * TEXTURE_WIDTH;
    for (const [vertex, hold] of this.holds.entries()) {
      for (let column = 0; column < 3; column++) {
        const from = 9 * hold + 3 * column;
        const to = first + 4 * (3 * vertex + column);
        for (let axis = 0; axis < 3; axis++) data[to + axis] = field[from + axis];
      }
    }
    texture.needsUpdate = true;
  }

  dispose(): void {
    this.target?.texture.dispose();
  }
}
