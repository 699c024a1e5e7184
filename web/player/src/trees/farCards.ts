/** Impostors of simulated trees, as the scene supplies them: what they need to know of the trees and their motion. */
import type { Texture } from "three";
import type { DrawnMotion } from "../core/table/drawnTable";
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

/** Fills the cards of a draw list, with the texels of their nodes; returns their number. */
export function fillCards(
  { data, bend }: CardRoom,
  list: DrawList,
  instances: Float32Array,
  texels: readonly LevelTexels[],
  levels: DrawnMotion["levels"],
): number {
  let count = 0;
  for (const [level, { bend: nodes }] of levels.entries()) {
    const { first, trees, nodes: perTree } = texels[level];
    const fitting = Math.min(trees, list.visible[level] + list.hidden[level]);
    for (let k = 0; k < fitting; k++) {
      const tree = list.order[list.start[level] + k];
      if (list.card[tree] <= 0) continue;
      const to = 12 * count;
      const from = tree * INSTANCE_FLOATS;
      for (let i = 0; i < INSTANCE_FLOATS; i++) data[to + i] = instances[from + i];
      data[to + 3] = list.card[tree];
      data[to + 7] = (tree * 0.618034) % 1;
      bend[4 * count] = first + k * perTree + nodes[0];
      bend[4 * count + 1] = first + k * perTree + nodes[1];
      count++;
    }
  }
  return count;
}
