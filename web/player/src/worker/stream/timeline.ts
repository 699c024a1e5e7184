/**
 * Plays poses that arrive TICK_HZ times a second over a network at the display's frame rate. Pure.
 *
 * The clock runs slightly behind the newest frame. The delay adapts slowly to the network's jitter, so that the trees
 * neither stop nor jump.
 */
import { TICK_HZ } from "../../core/constants";

export interface PoseFrame {
  readonly time_s: number;
  readonly poses: Float32Array[];
}

const TICK_S = 1 / TICK_HZ;
const MAX_BEHIND_S = 0.5;

export class PoseTimeline {
  private frames: PoseFrame[] = [];
  private spare: Float32Array[][] = [];
  private now_s = Number.NaN;
  private delay_s = 2 * TICK_S;

  constructor(private readonly lengths: readonly number[]) {}

  /** Buffers to fill for the next frame, reused. */
  take(): Float32Array[] {
    return this.spare.pop() ?? this.lengths.map((length) => new Float32Array(length));
  }

  /** Adds a frame, later than all previous ones. */
  push(time_s: number, poses: Float32Array[]): void {
    this.frames.push({ time_s, poses });
    if (Number.isNaN(this.now_s)) this.now_s = time_s - this.delay_s;
    while (this.frames.length > 16) this.drop();
  }

  private drop(): void {
    const old = this.frames.shift();
    if (old) this.spare.push(old.poses);
  }

  /** Advances the displayed time, converging to `delay` behind the newest frame. */
  advance(dt_s: number): number {
    const newest = this.frames.at(-1);
    if (!newest) return 0;
    const wanted = newest.time_s - this.delay_s;
    const error = wanted - this.now_s;
    if (Math.abs(error) > MAX_BEHIND_S) this.now_s = wanted;
    else this.now_s += Math.max(0, dt_s + error * Math.min(1, 2 * dt_s));
    this.now_s = Math.min(this.now_s, newest.time_s);
    while (this.frames.length > 2 && this.frames[1].time_s <= this.now_s) this.drop();
    return this.now_s;
  }

  /** Writes the poses at the displayed time; returns false before the first frame. */
  sample(out: readonly Float32Array[]): boolean {
    const [a, b = a] = this.frames;
    if (!a) return false;
    const span = b.time_s - a.time_s;
    const t = span > 0 ? Math.min(1, Math.max(0, (this.now_s - a.time_s) / span)) : 1;
    out.forEach((buffer, group) => {
      const from = a.poses[group];
      const to = b.poses[group];
      for (let i = 0; i < buffer.length; i++) buffer[i] = from[i] + t * (to[i] - from[i]);
    });
    return true;
  }
}
