import type { WindDocument } from "../../core/wind/wind";
import type { Connection, Inspection, TreeAt } from "../protocol";

/** A source of poses for all groups: the tables in this browser, or the server's stream. */
export interface MotionSource {
  readonly time_s: number;
  readonly connection: Connection;
  /** Share of the trees that are in winds that their tables have sampled. */
  readonly coverage: number;
  /** How far the tree that is farthest is into its sampled range: above 1 it is beyond. */
  readonly extrapolationRatio: number;
  /** Time spent on the wind since last asked, ms. */
  takeWind_ms(): number;
  inspect(at: TreeAt): Inspection | null;
  /** The wind glides to another; the field that both share is told by the caller. */
  windChanged(wind: WindDocument): void;
  /** Stops a shared forest's clock for all, or lets it run on. */
  pause?(paused: boolean): void;
  /** Moves on and fills a row of `poseStride(modes)` floats per tree; false while no pose is known. */
  advance(dt_s: number, out: readonly Float32Array[]): boolean;
  dispose(): void;
}
