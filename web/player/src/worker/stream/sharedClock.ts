/** The clock of a shared forest, and how this display converges to it. Pure. */
import type { Clock } from "../../core/wire/wire";
import type { ServerClock } from "./serverClock";

/** If the error is larger, the forest jumps to the shared time. */
const JUMP_S = 0.5;

export class SharedClock {
  private latest: Clock | null = null;

  constructor(private readonly server: ServerClock) {}

  update(clock: Clock): void {
    this.latest = clock;
  }

  get paused(): boolean {
    return this.latest?.paused ?? false;
  }

  /** Converts local clock time to the forest's time; null until it is known. */
  time_s(now_ms: number): number | null {
    if (!this.latest) return null;
    if (this.latest.paused) return this.latest.time_s;
    const age_ms = this.server.age_ms(this.latest.made_s, now_ms);
    return age_ms === null ? null : this.latest.time_s + Math.max(0, age_ms) / 1000;
  }

  /** Time step of a forest at `mine_s`: converges to the shared time and is never negative. */
  step(mine_s: number, dt_s: number, now_ms: number): { jump_s: number | null; dt_s: number } {
    const shared_s = this.time_s(now_ms);
    if (shared_s === null) return { jump_s: null, dt_s };
    const error_s = shared_s - (mine_s + (this.paused ? 0 : dt_s));
    if (Math.abs(error_s) > JUMP_S) return { jump_s: shared_s, dt_s: 0 };
    const free_s = this.paused ? 0 : dt_s;
    return { jump_s: null, dt_s: Math.max(0, free_s + error_s * Math.min(1, 2 * dt_s)) };
  }
}
