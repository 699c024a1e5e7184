/** How the visitor plays the forest's motion: paused, slowed down, or one step at a time. Pure. */
import { signal } from "@preact/signals-core";

export const PLAYBACK_SPEEDS = { Normal: 1, Half: 0.5, Quarter: 0.25 } as const;
/** Length of a single step, s: one frame of the tables. */
export const STEP_S = 1 / 30;

export class Playback {
  /** Speed of the motion computed in this browser, over real time; a streamed forest keeps its own. */
  speed = 1;
  private readonly stopped = signal(false);
  private steps = 0;

  /** A signal: whoever reads it in an effect follows it. */
  get paused(): boolean {
    return this.stopped.value;
  }

  set paused(paused: boolean) {
    this.stopped.value = paused;
    this.steps = 0;
  }

  /** Pauses, and moves on by one step in the next frame. */
  step(): void {
    if (!this.paused) this.paused = true;
    this.steps++;
  }

  /** Time by which a frame of `real_s` advances the motion, s; null if it stands still. */
  advance_s(real_s: number, streamed: boolean): number | null {
    if (!this.paused) return streamed ? real_s : real_s * this.speed;
    if (this.steps === 0) return null;
    this.steps--;
    return STEP_S;
  }
}
