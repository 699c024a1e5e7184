/** The trees that one pass draws, as a texture: three texels per tree, those of each draw one after the other. */

import { LEVEL_COUNT } from "../detail";
import type { DrawList } from "../drawList";
import { copyTree, INSTANCE_FLOATS, isSpacious, roomFor } from "../instanceData";
import { flatTexture, uploadRuns } from "../nodes/flatTexture";
import type { LevelTexels } from "../nodes/treeNodes";
import type { TreesUniforms } from "../treeShader";
import { DRAWS_PER_CALL } from "./togetherShader";

const TEXELS_PER_TREE = INSTANCE_FLOATS / 4;

/** What a pass takes of the draw list. */
export interface Taken {
  /** Trees of each level. */
  readonly counts: ArrayLike<number>;
  /** Place of a tree in the order of the list. */
  placeOf(level: number, i: number): number;
  readonly shares: Float32Array;
  /** Largest share that is drawn. */
  readonly mostShare: number;
}

export class TreeTable {
  private flat = flatTexture(0, 4);
  private room = 0;
  private readonly from = new Int32Array(DRAWS_PER_CALL);
  readonly uniforms: TreesUniforms = {
    uTrees: { value: this.flat.texture },
    uTreesFrom: { value: this.from },
  };

  fill(list: DrawList, instances: Float32Array, texels: readonly LevelTexels[], taken: Taken): void {
    let trees = 0;
    for (let level = 0; level < LEVEL_COUNT; level++) trees += taken.counts[level];
    if (trees > this.room || isSpacious(this.room, trees)) this.makeRoom(trees);
    let to = 0;
    for (let level = 0; level < LEVEL_COUNT; level++) {
      const { first, nodes } = texels[level];
      this.from[level] = to;
      for (let i = 0; i < taken.counts[level]; i++, to++) {
        const place = taken.placeOf(level, i);
        const tree = list.order[place];
        const share = Math.min(taken.mostShare, taken.shares[tree]);
        const texel = first + (place - list.start[level]) * nodes;
        copyTree(instances, tree, this.flat.data, to * INSTANCE_FLOATS, texel, share);
      }
    }
    if (trees > 0) uploadRuns(this.flat.texture, [[0, trees * TEXELS_PER_TREE]]);
  }

  private makeRoom(trees: number): void {
    this.flat.texture.dispose();
    this.room = roomFor(trees);
    this.flat = flatTexture(this.room * TEXELS_PER_TREE, 4);
    this.uniforms.uTrees.value = this.flat.texture;
  }

  dispose(): void {
    this.flat.texture.dispose();
  }
}
