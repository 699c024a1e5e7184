/** The FOREST message of a plan. Pure. */

import { MOST_STREAMED_TREES } from "../../core/constants";
import type { Method } from "../../core/motion/method";
import type { WindField } from "../../core/wind/field";
import type { Forest } from "../../core/wire/wire";
import type { ShareRequest } from "../protocol";

export interface PlannedGroup {
  readonly table: string;
  readonly placement: Float32Array;
}

/** The server moves all groups by one method: the paper's only if it has the records of every table. */
export function streamMethod(method: Method, groups: readonly { readonly recorded: boolean }[]): Method {
  return groups.every(({ recorded }) => recorded) ? method : "modal";
}

/**
 * The groups of a shared forest as its clients name them: by their tables in leaf, which are the same in every season,
 * whichever ones a client plays itself.
 */
export function sharedGroups<Group extends PlannedGroup & { readonly leafTable: string }>(
  groups: readonly Group[],
): Group[] {
  return groups.map((group) => ({ ...group, table: group.leafTable }));
}

export interface PlanOptions {
  readonly method: Method;
  readonly poseEasing: number | null;
  readonly share?: ShareRequest | null;
  /** Size in bytes of the tables that are already loaded. */
  readonly have?: Record<string, number>;
}

export function forestRequest(
  mode: "stream" | "table",
  groups: readonly PlannedGroup[],
  field: WindField,
  time_s: number,
  { method, poseEasing, share, have }: PlanOptions,
): Forest {
  const count = groups.reduce((sum, { placement }) => sum + placement.length / 4, 0);
  // A larger forest is played by its clients, who know the places: the server has no use for them.
  const isPlaced = mode === "stream" || count <= MOST_STREAMED_TREES;
  return {
    type: "forest",
    mode,
    groups: groups.map(({ table, placement }) => ({ table, count: placement.length / 4 })),
    wind: { ...field.state },
    time_s,
    pose_easing: poseEasing,
    method,
    ...(share && { share: share.id, replant: share.replant, about: share.about }),
    ...(have && { have }),
    trees: isPlaced ? packed(groups, count) : new Float32Array(),
  };
}

/** Placements of all groups, concatenated. */
function packed(groups: readonly PlannedGroup[], count: number): Float32Array<ArrayBuffer> {
  const trees = new Float32Array(4 * count);
  let at = 0;
  for (const { placement } of groups) {
    trees.set(placement, at);
    at += placement.length;
  }
  return trees;
}
