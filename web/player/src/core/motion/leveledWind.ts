/** The wind at some trees of a group at a time, each at its own moment. Nothing is allocated per frame. */
import type { WindField } from "../wind/field";
import type { Moment } from "../wind/transition";
import { GroupWind } from "./groupWind";

export class LeveledWind extends GroupWind {
  /** Pressure of each tree when it was last evaluated, relative to the sampled maximum. */
  private readonly ratio = new Float32Array(this.count);
  /** Places of the trees that are evaluated, and the velocities there. */
  private readonly room = [0, 1, 2, 3].map(() => new Float64Array(this.count));

  /** Evaluates the wind at the listed trees. */
  updateSome(field: WindField, moment: Moment, trees: Uint32Array): void {
    const { velocityX, velocityZ, ratio } = this;
    const [x, z, outX, outZ] = this.room.map((all) => all.subarray(0, trees.length));
    for (let k = 0; k < trees.length; k++) {
      x[k] = this.x[trees[k]];
      z[k] = this.z[trees[k]];
    }
    const gusty = this.begin(moment);
    field.velocity(x, z, moment, outX, outZ);
    for (let k = 0; k < trees.length; k++) {
      const tree = trees[k];
      velocityX[tree] = outX[k];
      velocityZ[tree] = outZ[k];
      ratio[tree] = this.press(tree, gusty);
    }
  }

  override update(field: WindField, moment: Moment): void {
    super.update(field, moment);
    this.ratio.fill(this.extrapolationRatio);
  }

  /** Sums up what was evaluated last at each tree. */
  sumUp(): void {
    let beyond = 0;
    let strongest = 0;
    for (let tree = 0; tree < this.count; tree++) {
      const ratio = this.ratio[tree];
      if (ratio > 1) beyond++;
      if (ratio > strongest) strongest = ratio;
    }
    this.coverage = this.count === 0 ? 1 : 1 - beyond / this.count;
    this.extrapolationRatio = strongest;
  }
}
