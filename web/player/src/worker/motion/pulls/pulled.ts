/** What sources of poses know of pulled trees. Types, and the place of a tree. */
import { PULL_SAME_PLACE_M } from "../../../core/constants";
import type { PointResponse } from "../../../core/pull/pointResponse";
import type { PullOrder, TreeAt } from "../../protocol";

/** A pulled tree: the force acts on the response's point, N, in the tree's frame at scale 1. */
export interface Pulled {
  readonly order: PullOrder;
  readonly table: string;
  readonly response: PointResponse;
  readonly force_N: ArrayLike<number>;
}

/** Hands that belong together: the same point of the same tree. */
export const samePoint = (a: PullOrder, b: PullOrder): boolean =>
  a.vertex === b.vertex && a.at.group === b.at.group && a.at.tree === b.at.tree;

/** The tree at a place; `placements`: x, z, yaw, scale of each tree, by group. */
export function treeAtPlace(placements: readonly Float32Array[], x: number, z: number): TreeAt | null {
  for (const [group, placement] of placements.entries()) {
    for (let tree = 0; tree < placement.length / 4; tree++) {
      const gap = Math.hypot(placement[4 * tree] - x, placement[4 * tree + 1] - z);
      if (gap <= PULL_SAME_PLACE_M) return { group, tree };
    }
  }
  return null;
}
