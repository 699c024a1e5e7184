/** Impostors of simulated trees, as the scene supplies them: what they need to know of the trees and their motion. */
import type { Texture } from "three";
import type { DrawnMotion } from "../core/table/drawnTable";
import { LEVEL_COUNT } from "./detail";
import type { DrawList } from "./drawList";
import { INSTANCE_FLOATS } from "./instanceData";
import type { LevelTexels } from "./nodes/treeNodes";

export interface FarCards {
  /** Distance (m) from which trees of scale 1 are drawn as impostors; infinite while there are none. */
  readonly from_m: number;
  /** Draws the cards of a draw list, moved by the nodes in this target of pass 1. */
  show(
    list: DrawList,
    instances: Float32Array,
    texels: readonly LevelTexels[],
    nodes: Texture,
    shift: number,
  ): void;
  dispose(): void;
}

/** Room for cards: 12 and 4 floats each. */
interface CardRoom {
  readonly data: Float32Array;
  readonly bend: Float32Array;
}

/** Two nodes of the trunk by which a whole tree bends. */
export interface BendNodes {
  readonly middle: number;
  readonly tip: number;
  /** Height of the middle one relative to the tip. */
  readonly middleAt: number;
}

/** The nodes nearest to the axis halfway up and at the top. */
export function bendNodes({ rest_m, height_m }: Pick<DrawnMotion, "rest_m" | "height_m">): BendNodes {
  const nearest = (share: number) => {
    let best = 0;
    let least = Number.POSITIVE_INFINITY;
    for (let node = 0; node < rest_m.length / 3; node++) {
      const [x, y, z] = rest_m.subarray(3 * node, 3 * node + 3);
      const far = Math.abs(y - share * height_m) + Math.hypot(x, z);
      if (far >= least) continue;
      least = far;
      best = node;
    }
    return best;
  };
  const [middle, tip] = [nearest(0.55), nearest(1)];
  const at = rest_m[3 * middle + 1] / Math.max(1e-3, rest_m[3 * tip + 1]);
  return { middle, tip, middleAt: Math.min(0.8, Math.max(0.2, at)) };
}

/** Fills the cards of a draw list, with the texels of their nodes; returns their number. */
export function fillCards(
  { data, bend }: CardRoom,
  list: DrawList,
  instances: Float32Array,
  texels: readonly LevelTexels[],
  levels: DrawnMotion["levels"],
  nodes: BendNodes,
): number {
  let count = 0;
  for (let level = 0; level < LEVEL_COUNT; level++) {
    const { first, trees, nodes: perTree } = texels[level];
    const { of } = levels[level];
    const fitting = Math.min(trees, list.visible[level] + list.hidden[level]);
    for (let k = 0; k < fitting; k++) {
      const tree = list.order[list.start[level] + k];
      if (list.card[tree] <= 0) continue;
      const to = 12 * count;
      const from = tree * INSTANCE_FLOATS;
      for (let i = 0; i < INSTANCE_FLOATS; i++) data[to + i] = instances[from + i];
      data[to + 3] = list.card[tree];
      data[to + 7] = (tree * 0.618034) % 1;
      bend[4 * count] = first + k * perTree + of[nodes.middle];
      bend[4 * count + 1] = first + k * perTree + of[nodes.tip];
      count++;
    }
  }
  return count;
}
