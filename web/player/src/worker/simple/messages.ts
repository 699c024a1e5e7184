/** Messages between a forest and its worker. Types only. */

import type { Viewer } from "../../core/motion/simulationLevels";
import type { DrawnMotion } from "../../core/table/drawnTable";
import type { WindDocument } from "../../core/wind/document";

export type Floats = Float32Array<ArrayBuffer>;

/** The poses of one group, and the wind at its trees if it is a function: x and z of each (m/s). */
export interface GroupFrame {
  readonly group: number;
  readonly poses: Floats;
  readonly velocity: Floats | null;
}

export type ToWorker =
  | { readonly kind: "load"; readonly table: number; readonly from: string | ArrayBuffer }
  /** `placement`: x, z, yaw, scale of each tree. Also moves a group that exists; its trees keep their pose. */
  | { readonly kind: "plant"; readonly group: number; readonly table: number; readonly placement: Floats }
  | { readonly kind: "remove"; readonly group: number }
  /** null: velocities come with every frame. */
  | { readonly kind: "wind"; readonly wind: WindDocument | null }
  /** Returns the frames, filled. */
  | {
      readonly kind: "advance";
      readonly dt_s: number;
      readonly viewer: Viewer;
      readonly frames: readonly GroupFrame[];
    };

export type FromWorker =
  | { readonly kind: "table"; readonly table: number; readonly motion: DrawnMotion }
  | { readonly kind: "failed"; readonly table: number; readonly fault: string }
  | { readonly kind: "poses"; readonly time_s: number; readonly frames: readonly GroupFrame[] };
