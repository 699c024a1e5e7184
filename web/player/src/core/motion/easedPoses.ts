/** The poses of one group as the page keeps them: distant trees move to each new pose over several frames. Pure. */
import { coordinateOf, type PosePacket, windOf } from "./posePacket";
import { poseStride } from "./poseStride";

/** How poses are to be displayed that are reached over several frames. */
export interface Easing {
  /**
   * Takes a tree, whose newest pose has these coordinates in `data` from `at` on, back to where it is on the way there.
   */
  ease(tree: number, coordinates: Uint16Array, data: Float32Array, at: number): void;
}

export class EasedPoses implements Easing {
  /** [count, poseStride(modes)] newest poses. */
  readonly poses: Float32Array<ArrayBuffer>;
  /** [count, coordinates] where distant trees come from. */
  readonly before: Float32Array;
  private readonly stride: number;
  /** Frames that the newest pose of each tree takes to be reached (0: it is reached), and the first of them. */
  private readonly period: Uint8Array;
  private readonly since: Uint32Array;
  private frame = 0;

  /** `coordinates`: of distant trees. */
  constructor(
    count: number,
    private readonly modes: number,
    readonly coordinates: Uint16Array,
  ) {
    this.stride = poseStride(modes);
    this.poses = new Float32Array(count * this.stride);
    this.before = new Float32Array(count * coordinates.length);
    this.period = new Uint8Array(count);
    this.since = new Uint32Array(count);
  }

  /** How much of the way to its newest pose a tree has gone, 0..1. */
  share(tree: number): number {
    const period = this.period[tree];
    return period === 0 ? 1 : Math.min(1, (this.frame - this.since[tree] + 1) / period);
  }

  ease(tree: number, coordinates: Uint16Array, data: Float32Array, at: number): void {
    const share = this.share(tree);
    if (share === 1) return;
    const width = this.coordinates.length;
    for (let k = 0; k < width; k++) {
      const to = at + coordinates.indexOf(this.coordinates[k]);
      if (to < at) continue;
      const past = this.before[tree * width + k];
      data[to] = past + share * (data[to] - past);
    }
  }

  /** Takes a part of the next frame's packet; `at`: where it begins, which is moved behind it. */
  take(packet: PosePacket, group: number, at: { row: number; near: number; far: number }): void {
    this.frame++;
    const { near, all, far, periods } = packet.groups[group];
    if (all) {
      this.poses.set(packet.rows.subarray(at.row, at.row + this.poses.length));
      this.period.fill(0);
    } else this.takeNear(packet, near, at);
    at.row += near * this.stride;
    if (!all) at.near += near;
    for (const [level, count] of far.entries()) {
      for (let k = at.far; k < at.far + count; k++) this.takeFar(packet, k, periods[level]);
      at.far += count;
    }
  }

  private takeNear({ rows, near }: PosePacket, count: number, at: { row: number; near: number }): void {
    const { poses, stride, period } = this;
    for (let k = 0; k < count; k++) {
      const tree = near[at.near + k];
      const [from, to] = [at.row + k * stride, tree * stride];
      for (let c = 0; c < stride; c++) poses[to + c] = rows[from + c];
      period[tree] = 0;
    }
  }

  /** From what is displayed to the next pose. */
  private takeFar({ leading, far }: PosePacket, at: number, period: number): void {
    const { poses, before, coordinates, stride, modes } = this;
    const tree = far[at];
    this.frame--; // what the last frame displayed
    const share = this.share(tree);
    this.frame++;
    const width = coordinates.length;
    for (let k = 0; k < width; k++) {
      const from = before[tree * width + k];
      const to = tree * stride + coordinates[k];
      before[tree * width + k] = share < 1 ? from + share * (poses[to] - from) : poses[to];
      poses[to] = coordinateOf(leading, at, k);
    }
    poses[tree * stride + modes] = windOf(leading, at);
    this.period[tree] = period;
    this.since[tree] = this.frame;
  }
}
