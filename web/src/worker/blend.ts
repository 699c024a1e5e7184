/** Hides a jump of all poses (another lookup place, a reconnect): the difference fades out. Pure. */

const FADE_S = 0.7;

export class JumpBlend {
  private offsets: Float32Array[] = [];
  private left_s = 0;

  /** `shown` is what the screen has now; the next poses start from there. */
  start(shown: readonly Float32Array[]): void {
    this.offsets = shown.map((buffer) => buffer.slice());
    this.left_s = FADE_S;
    this.fresh = true;
  }

  private fresh = false;

  /** Adds what remains of the old pose; call once per frame with the new poses. */
  apply(buffers: readonly Float32Array[], dt_s: number): void {
    if (this.left_s <= 0) return;
    if (this.fresh) this.takeDifference(buffers);
    this.left_s = Math.max(0, this.left_s - dt_s);
    const t = this.left_s / FADE_S;
    const weight = t * t * (3 - 2 * t);
    buffers.forEach((buffer, group) => {
      const offset = this.offsets[group];
      for (let i = 0; i < buffer.length; i++) buffer[i] += weight * offset[i];
    });
  }

  private takeDifference(buffers: readonly Float32Array[]): void {
    this.fresh = false;
    if (!buffers.every((buffer, group) => this.offsets[group]?.length === buffer.length)) this.left_s = 0;
    else {
      buffers.forEach((buffer, group) => {
        const offset = this.offsets[group];
        for (let i = 0; i < buffer.length; i++) offset[i] -= buffer[i];
      });
    }
  }
}
