/** Trees of one kind that were planted together. */
import type { Matrix4, Vector3 } from "three";
import { NodePose } from "../core/motion/nodePose";
import { tipNode } from "../core/motion/tip";
import type { DrawnMotion } from "../core/table/drawnTable";
import type { SpeciesForest } from "../trees/speciesForest";

export class Planted {
  private readonly pose: NodePose;

  /** Made by `Forest.plant`. */
  constructor(
    /** @internal */ readonly group: number,
    /** @internal */ readonly table: number,
    /** @internal */ readonly motion: DrawnMotion,
    /** @internal */ readonly trees: SpeciesForest,
    /** @internal */ public matrices: readonly Matrix4[],
    private readonly posesNow: () => Float32Array | null,
    private readonly world: () => Matrix4,
  ) {
    this.pose = new NodePose(motion);
  }

  /** Number of trees. */
  get count(): number {
    return this.matrices.length;
  }

  /** Height of a tree of scale 1, m. */
  get height_m(): number {
    return this.motion.height_m;
  }

  /** Where the tip of a tree is now, in the world. */
  tip(tree: number, target: Vector3): Vector3 {
    const { motion, pose, matrices } = this;
    if (!matrices[tree]) throw new RangeError(`tree ${tree}: expected a number in 0..${this.count - 1}`);
    const at = 3 * tipNode(motion);
    const { moved } = pose.take(this.posesNow(), tree * motion.stride);
    const [x, y, z] = [0, 1, 2].map((axis) => motion.rest_m[at + axis] + moved[at + axis]);
    return target.set(x, y, z).applyMatrix4(matrices[tree]).applyMatrix4(this.world());
  }
}
