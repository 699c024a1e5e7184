/** Hides a jump of all poses (another lookup place, a replanting): the difference fades out. Pure. */

const FADE_S = 0.7;

export class JumpBlend {
  /** Pose shown before, then (once the new one is known) its difference to the new. */
  private offsets: Float32Array[] = [];
  private left_s = 0;
  private pending = false;

  /** `shown` is what the screen has now; the next poses start from there. */
  start(shown: readonly Float32Array[]): void {
    this.offsets = shown.map((buffer) => buffer.slice());
    this.left_s = FADE_S;
    this.pending = true;
  }

  /** Adds what remains of the old pose to the new ones; call once per frame. */
  apply(buffers: readonly Float32Array[], dt_s: number): void {
    if (this.left_s <= 0) return;
    if (this.pending && !this.takeDifference(buffers)) return;
    this.left_s = Math.max(0, this.left_s - dt_s);
    const t = this.left_s / FADE_S;
    const weight = t * t * (3 - 2 * t);
    for (const [group, buffer] of buffers.entries()) {
      const offset = this.offsets[group];
      for (let i = 0; i < buffer.length; i++) buffer[i] += weight * offset[i];
    }
  }

  /** False for another forest: nothing to fade from. */
  private takeDifference(buffers: readonly Float32Array[]): boolean {
    this.pending = false;
    const same =
      buffers.length === this.offsets.length &&
      buffers.every((buffer, group) => this.offsets[group].length === buffer.length);
    if (!same) {
      this.left_s = 0;
      return false;
    }
    for (const [group, buffer] of buffers.entries()) {
      const offset = this.offsets[group];
      for (let i = 0; i < buffer.length; i++) offset[i] -= buffer[i];
    }
    return true;
  }
}
