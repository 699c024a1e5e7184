/** The wind at the trees of many groups, for all of them at once: a call for each of hundreds of tables would take longer than their steps. */
import type { WindField } from "../wind/field";
import type { Moment } from "../wind/transition";
import type { Chosen, GroupWind } from "./groupWind";

export class JointWind {
  /** x, z and velocities along x and z of the evaluated trees, group by group. */
  private readonly room: Float64Array[];
  /** Where the trees of each group begin in it, if all are there. */
  private readonly whole: Int32Array;

  constructor(private readonly winds: readonly GroupWind[]) {
    const count = winds.reduce((sum, wind) => sum + wind.count, 0);
    this.room = [0, 1, 2, 3].map(() => new Float64Array(count));
    this.whole = new Int32Array(winds.length).fill(-1);
  }

  /** Evaluates the wind at all trees, or at those of each group that are chosen. */
  update(field: WindField, moment: Moment, chosen: readonly Chosen[] = []): void {
    const { winds, room, whole } = this;
    let count = 0;
    for (let g = 0; g < winds.length; g++) {
      const trees = chosen[g] ?? null;
      if (trees || whole[g] !== count) winds[g].place(trees, room[0], room[1], count);
      whole[g] = trees ? -1 : count;
      count += trees?.length ?? winds[g].count;
    }
    const [x, z, outX, outZ] = count < room[0].length ? room.map((all) => all.subarray(0, count)) : room;
    field.velocity(x, z, moment, outX, outZ);
    let first = 0;
    for (let g = 0; g < winds.length; g++) {
      const trees = chosen[g] ?? null;
      if (trees?.length === 0) continue;
      winds[g].take(moment, trees, outX, outZ, first);
      first += trees?.length ?? winds[g].count;
    }
  }
}
