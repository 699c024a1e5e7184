/** Hides a jump of the poses (new source or table) by fading out the difference of each tree. Pure. */
import type { Changed } from "../../core/motion/leveledTrees";
import type { CarriedGroup } from "./carry";

const FADE_S = 1;

function addRow(to: Float32Array, offset: Float32Array, weight: number, from: number, length: number): void {
  for (let i = from; i < from + length; i++) to[i] += weight * offset[i];
}

export class JumpBlend {
  /** The pose before the jump; once the new one is known, the difference between them. */
  private offsets: (Float32Array | null)[] = [];
  private known: (Uint8Array | null)[] = [];
  private left_s = 0;
  private pending = false;

  /** Blends the next poses from those displayed now; null groups and unknown trees are not blended. */
  start(shown: readonly (CarriedGroup | null)[]): void {
    this.offsets = shown.map((group) => group?.poses.slice() ?? null);
    this.known = shown.map((group) => group?.known ?? null);
    this.left_s = FADE_S;
    this.pending = true;
  }

  /**
   * Adds the remaining difference to the new poses; call once per frame. `changed`: of each group the trees whose poses are
   * new, all where it is missing.
   */
  apply(buffers: readonly Float32Array[], dt_s: number, changed: readonly (Changed | null)[] = []): void {
    if (this.left_s <= 0) return;
    if (this.pending) this.takeDifferences(buffers);
    else this.left_s = Math.max(0, this.left_s - dt_s);
    const t = this.left_s / FADE_S;
    const weight = t * t * (3 - 2 * t);
    for (const [group, buffer] of buffers.entries()) {
      const offset = this.offsets[group];
      if (!offset) continue;
      const trees = changed[group];
      if (!trees) addRow(buffer, offset, weight, 0, buffer.length);
      else {
        const stride = buffer.length / (this.known[group]?.length ?? 1);
        for (const tree of trees.near) addRow(buffer, offset, weight, tree * stride, stride);
        for (const tree of trees.far.flatMap((far) => [...far]))
          for (const k of trees.coordinates) buffer[tree * stride + k] += weight * offset[tree * stride + k];
      }
    }
  }

  private takeDifferences(buffers: readonly Float32Array[]): void {
    this.pending = false;
    let largest = 0;
    for (const [group, buffer] of buffers.entries()) {
      const offset = this.offsets[group];
      const known = this.known[group];
      if (!offset || !known || offset.length !== buffer.length) {
        this.offsets[group] = null;
        continue;
      }
      const stride = buffer.length / known.length;
      for (let i = 0; i < buffer.length; i++) {
        offset[i] = known[Math.floor(i / stride)] === 0 ? 0 : offset[i] - buffer[i];
        largest = Math.max(largest, Math.abs(offset[i]));
      }
    }
    if (largest === 0) this.left_s = 0; // no tree jumps
  }
}
