/** The displayed poses and how fast they change, so that new sources and tables continue from them. Pure. */

import { poseStride } from "../../core/motion/poseStride";
import { type CarriedGroup, carryGroup, rowsBefore, type ShownGroup } from "./carry";

/** Poses to continue from, with their rates of change per second. */
export interface StartOfGroup extends CarriedGroup {
  readonly rates: Float32Array;
}

/** Floats that are kept per frame: the poses of 10,000 trees. */
const MOST_KEPT = 320_000;
/** Time over which the rates of a new plan are remembered. */
const RATE_S = 1 / 60;

export class ShownPoses {
  private groups: readonly ShownGroup[] = [];
  private now: Float32Array[] = [];
  private last: Float32Array[] = [];
  /** Time at which each part of the last poses was kept; large forests are kept in parts, one part a frame. */
  private kept_s: Float64Array = new Float64Array(1);
  private now_s = 0;
  private frame = 0;

  /** The displayed trees in the coordinates of these groups, which are displayed from now on; null for a new group. */
  continueAs(groups: readonly ShownGroup[]): (StartOfGroup | null)[] {
    const starts = groups.map((group) => this.startOf(group));
    const empty = ({ table, ids }: ShownGroup) =>
      new Float32Array(ids.length * poseStride(table.metadata.modes));
    this.groups = groups;
    this.now = groups.map((group, g) => starts[g]?.poses.slice() ?? empty(group));
    const floats = this.now.reduce((sum, { length }) => sum + length, 0);
    this.kept_s = new Float64Array(Math.max(1, Math.ceil(floats / MOST_KEPT))).fill(this.now_s - RATE_S);
    this.last = this.now.map((poses, g) => {
      const rates = starts[g]?.rates;
      return rates ? poses.map((pose, i) => pose - RATE_S * rates[i]) : poses.slice();
    });
    return starts;
  }

  /** Displays these trees, at rest in their poses. */
  show(groups: readonly ShownGroup[], poses: readonly Float32Array[]): void {
    this.groups = groups;
    this.now = [...poses];
    this.last = [...poses];
  }

  private startOf(group: ShownGroup): StartOfGroup | null {
    const carried = carryGroup(group, this.groups, this.now);
    const before = carried && carryGroup(group, this.groups, this.last);
    if (!carried || !before) return null;
    const parts = this.kept_s.length;
    const stride = carried.poses.length / Math.max(1, carried.known.length);
    const trees = this.groups.find(({ key }) => key === group.key)?.ids ?? [];
    const rows = rowsBefore(trees, group.ids);
    const rates = carried.poses.map((pose, i) => {
      const row = Math.max(0, rows[Math.floor(i / stride)]);
      const since_s = this.now_s - this.kept_s[Math.floor((row * parts) / trees.length)];
      return since_s > 0 ? (pose - before.poses[i]) / since_s : 0;
    });
    return { ...carried, rates };
  }

  /** The poses of each group that are displayed, which the next frame changes; call `begin` before. */
  get buffers(): readonly Float32Array[] {
    return this.now;
  }

  /** Keeps the displayed poses before a frame that lasts dt_s. */
  begin(dt_s: number): void {
    if (dt_s <= 0) return;
    const parts = this.kept_s.length;
    const part = this.frame++ % parts;
    for (const [g, poses] of this.now.entries()) {
      const trees = this.groups[g].ids.length;
      const stride = poses.length / Math.max(1, trees);
      const [from, to] = [part, part + 1].map((k) => stride * Math.ceil((k * trees) / parts));
      this.last[g].set(poses.subarray(from, to), from);
    }
    this.kept_s[part] = this.now_s;
    this.now_s += dt_s;
  }

  /** Every displayed tree. */
  get all(): CarriedGroup[] {
    return this.now.map((poses, g) => ({ poses, known: new Uint8Array(this.groups[g].ids.length).fill(1) }));
  }
}
