import type { WindDocument } from "../../core/wind/wind";
/** The interface of everything that produces poses. */
import type { Connection, Inspection, TreeAt } from "../protocol";

/** A source of poses for all groups: the tables in this browser, or the server's stream. */
export interface MotionSource {
  readonly time_s: number;
  readonly connection: Connection;
  /** Share of the trees that are in winds that their tables have sampled. */
  readonly coverage: number;
  /** Largest extrapolation ratio of all trees: above 1 one is beyond its sampled range. */
  readonly extrapolationRatio: number;
  /** Time spent on the wind since the last call, ms. */
  takeWind_ms(): number;
  inspect(at: TreeAt): Inspection | null;
  /** The wind changes to another document; the caller updates the shared field. */
  windChanged(wind: WindDocument): void;
  /** Stops or resumes the clock of a shared forest, for everyone. */
  pause?(paused: boolean): void;
  /** Advances and fills `poseStride(modes)` floats per tree; false while no pose is known. */
  advance(dt_s: number, out: readonly Float32Array[]): boolean;
  dispose(): void;
}
