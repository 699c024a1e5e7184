import type { Changed } from "../../core/motion/leveledTrees";
import type { Viewer } from "../../core/motion/simulationLevels";
import type { WindDocument } from "../../core/wind/document";
/** The interface of everything that produces poses. */
import type { Connection, Inspection, PullOrder, TreeAt } from "../protocol";
import type { Pulled } from "./pulls/pulled";

/** A source of poses for all groups: the tables in this browser, or the server's stream. */
export interface MotionSource {
  readonly time_s: number;
  readonly connection: Connection;
  /** Share of the trees within the sampled range of winds. */
  readonly coverage: number;
  /** Largest extrapolation ratio of all trees; above 1 a tree is beyond its sampled range. */
  readonly extrapolationRatio: number;
  /** Time spent on the wind since the last call, ms. */
  takeWind_ms(): number;
  inspect(at: TreeAt): Inspection | null;
  /** Tells the server of a change of the wind document; the caller updates the shared field. */
  sendWind?(wind: WindDocument): void;
  /** Stops or resumes the clock of a shared forest, for everyone. */
  pause?(paused: boolean): void;
  /** Trees far from the viewer or out of view may move with less detail. */
  see?(viewer: Viewer): void;
  /** The trees of each group whose poses the last `advance` wrote; null or absent: all of them. */
  readonly changed?: readonly (Changed | null)[];
  /** The tree whose figures are shown, which is stepped fully wherever it is. */
  watch?(at: TreeAt | null): void;
  /** Connects to the server at once if the connection is lost. */
  retry?(): void;
  /** Nobody looks at the page, or someone does again: the server need not send anything meanwhile. */
  hide?(hidden: boolean): void;
  /** Begins or continues a pull. */
  pull(order: PullOrder): void;
  release(hand: number): void;
  /** The trees that are pulled, by anyone, in the last poses. */
  readonly pulled: readonly Pulled[];
  /** Sends a gust front from a place, m. */
  gust(x_m: number, z_m: number): void;
  /** Advances and writes `poseStride(modes)` floats per tree; returns false while no poses are known. */
  advance(dt_s: number, out: readonly Float32Array[]): boolean;
  dispose(): void;
}
