/**
 * The server's stream with the local tables as fallback: the tables move the trees while no frames arrive, and the
 * stream takes over with its next frame. Both use the same wind, so the jump is small; the caller blends it.
 */
import type { Viewer } from "../../core/motion/simulationLevels";
import type { WindDocument } from "../../core/wind/document";
import type { Inspection, PullOrder, TreeAt } from "../protocol";
import type { LocalMotion } from "./localMotion";
import type { MotionSource } from "./motionSource";
import type { StreamMotion } from "./streamMotion";

export class FailoverMotion implements MotionSource {
  private local: LocalMotion | null = null;

  /** `makeLocal` starts at the given time; `switched` is called when the source of poses changes. */
  constructor(
    private readonly stream: StreamMotion,
    private readonly makeLocal: (time_s: number) => LocalMotion,
    private readonly switched: () => void,
  ) {}

  private get source(): MotionSource {
    return this.local ?? this.stream;
  }

  get time_s(): number {
    return this.source.time_s;
  }

  get connection() {
    return this.stream.connection;
  }

  get coverage(): number {
    return this.source.coverage;
  }

  get extrapolationRatio(): number {
    return this.source.extrapolationRatio;
  }

  takeWind_ms(): number {
    return this.source.takeWind_ms();
  }

  inspect(at: TreeAt): Inspection | null {
    return this.source.inspect(at);
  }

  sendWind(wind: WindDocument): void {
    this.stream.sendWind(wind);
  }

  pull(order: PullOrder): void {
    this.source.pull(order);
  }

  release(hand: number): void {
    this.stream.release(hand);
    this.local?.release(hand);
  }

  get pulled() {
    return this.source.pulled;
  }

  gust(x_m: number, z_m: number): void {
    this.source.gust(x_m, z_m);
  }

  pause(paused: boolean): void {
    this.stream.pause(paused);
  }

  see(viewer: Viewer): void {
    this.local?.see(viewer);
  }

  get changed() {
    return this.local?.changed;
  }

  watch(at: TreeAt | null): void {
    this.local?.watch(at);
  }

  retry(): void {
    this.stream.retry();
  }

  hide(hidden: boolean): void {
    this.stream.hide(hidden);
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    const lost = this.stream.connection.state === "lost";
    if (lost && !this.local) {
      this.local = this.makeLocal(this.stream.time_s);
      this.switched();
    } else if (!lost && this.local) {
      this.local.dispose();
      this.local = null;
      this.switched();
    }
    // The server continues from the current time of the local motion.
    if (this.local) this.stream.time_s = this.local.time_s;
    return this.source.advance(dt_s, out);
  }

  dispose(): void {
    this.stream.dispose();
    this.local?.dispose();
  }
}
