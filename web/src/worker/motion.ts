import type { WindDocument } from "../wind";
import type { Connection } from "./protocol";

/** A source of poses for all groups: the tables in this browser, or the server's stream. */
export interface MotionSource {
  readonly time_s: number;
  readonly connection: Connection;
  /** Share of the trees that are in winds that their tables have sampled. */
  readonly coverage: number;
  /** The wind glides to another; the field that both share is told by the caller. */
  windChanged(wind: WindDocument): void;
  /** Moves on and fills a row of `poseStride(modes)` floats per tree; false while no pose is known. */
  advance(dt_s: number, out: readonly Float32Array[]): boolean;
  dispose(): void;
}
