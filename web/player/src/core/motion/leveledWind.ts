/** The wind at the trees of a group that are not all evaluated at the same moment. */
import { GroupWind } from "./groupWind";

export class LeveledWind extends GroupWind {
  /** Pressure of each tree when it was last evaluated, relative to the sampled maximum. */
  private readonly ratio = new Float32Array(this.count);

  protected override press(tree: number, x: number, z: number): number {
    const ratio = super.press(tree, x, z);
    this.ratio[tree] = ratio;
    return ratio;
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
