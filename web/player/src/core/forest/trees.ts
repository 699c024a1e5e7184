/** Trees of one table as both the public forest and the worker step them: by the modal method. */
import { ModalForest } from "../modal/modalForest";
import { PlaceGusts } from "../modal/placeGusts";
import { GroupWind } from "../motion/groupWind";
import type { JointWind } from "../motion/jointWind";
import { SteppedTrees, stepsOf } from "../motion/steppedTrees";
import type { TreeInstances } from "../motion/treeInstances";
import type { Table } from "../table/table";
import type { WindField } from "../wind/field";

export type Trees = SteppedTrees<ModalForest>;

/** What steps so many trees of a table. */
export type Make = new (table: Table, count: number) => TreeInstances;

/** `placement`: x, z, yaw, scale of each tree. */
export function treesOf(table: Table, placement: Float32Array): Trees;
export function treesOf(table: Table, placement: Float32Array, make?: Make): SteppedTrees;
export function treesOf(table: Table, placement: Float32Array, make: Make = ModalForest): SteppedTrees {
  const { height_m, modes, streamlined_exponent } = table.metadata;
  const count = placement.length / 4;
  const wind = new GroupWind(placement, height_m, table.modal.limits[2], streamlined_exponent);
  return new SteppedTrees(new make(table, count), new PlaceGusts(table.modal, count), wind, modes);
}

/** The same trees, in the same pose, at other places. */
export function movedTo(trees: Trees, table: Table, placement: Float32Array): Trees {
  const moved = treesOf(table, placement);
  const rows = Int32Array.from({ length: Math.min(trees.lookup.count, moved.lookup.count) }, (_, i) => i);
  moved.lookup.adopt(trees.lookup, rows);
  return moved;
}

/** Advances all groups, in the wind at their trees, by a frame that ends at the returned time. */
export function advance(
  groups: readonly SteppedTrees[],
  wind: JointWind,
  field: WindField,
  time_s: number,
  dt_s: number,
): number {
  const { steps, step_s } = stepsOf(dt_s);
  let now_s = time_s;
  for (let step = 0; step < steps; step++) {
    now_s += step_s;
    const moment = field.at(now_s);
    wind.update(field, moment);
    for (const trees of groups) trees.step(step_s, moment);
  }
  return now_s;
}
