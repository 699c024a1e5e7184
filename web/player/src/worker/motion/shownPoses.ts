/** The displayed poses and how fast they change, so that new sources and tables continue from them. Pure. */

import { poseStride } from "../../core/motion/poseStride";
import { type CarriedGroup, carryGroup, type ShownGroup } from "./carry";

/** Poses to continue from, with their rates of change per second. */
export interface StartOfGroup extends CarriedGroup {
  readonly rates: Float32Array;
}

export class ShownPoses {
  private groups: readonly ShownGroup[] = [];
  private now: Float32Array[] = [];
  private last: Float32Array[] = [];
  private between_s = 0;

  /** The displayed trees in the coordinates of these groups, which are displayed from now on; null for a new group. */
  continueAs(groups: readonly ShownGroup[]): (StartOfGroup | null)[] {
    const starts = groups.map((group) => this.startOf(group));
    const empty = ({ table, ids }: ShownGroup) =>
      new Float32Array(ids.length * poseStride(table.metadata.modes));
    const { between_s } = this;
    this.groups = groups;
    this.now = groups.map((group, g) => starts[g]?.poses.slice() ?? empty(group));
    this.last = this.now.map((poses, g) => {
      const rates = starts[g]?.rates;
      return rates ? poses.map((pose, i) => pose - between_s * rates[i]) : poses.slice();
    });
    return starts;
  }

  private startOf(group: ShownGroup): StartOfGroup | null {
    const carried = carryGroup(group, this.groups, this.now);
    const before = carried && carryGroup(group, this.groups, this.last);
    if (!carried || !before) return null;
    const { between_s } = this;
    const rates = carried.poses.map((pose, i) => (between_s > 0 ? (pose - before.poses[i]) / between_s : 0));
    return { ...carried, rates };
  }

  /** Keeps the poses that are displayed now, dt_s after the last ones. */
  keep(buffers: readonly Float32Array[], dt_s: number): void {
    for (const [g, buffer] of buffers.entries()) {
      if (dt_s > 0) this.last[g].set(this.now[g]);
      this.now[g].set(buffer);
    }
    if (dt_s > 0) this.between_s = dt_s;
  }

  /** Writes the displayed poses. */
  write(buffers: readonly Float32Array[]): void {
    for (const [g, buffer] of buffers.entries()) buffer.set(this.now[g]);
  }

  /** Every displayed tree. */
  get all(): CarriedGroup[] {
    return this.now.map((poses, g) => ({ poses, known: new Uint8Array(this.groups[g].ids.length).fill(1) }));
  }
}
