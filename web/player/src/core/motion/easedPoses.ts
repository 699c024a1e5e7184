/** The poses of one group as the page keeps them: distant trees move to each new pose over several frames. Pure. */
import { coordinateOf, type PosePacket, windOf } from "./posePacket";
import { poseStride } from "./poseStride";

/** How poses are to be displayed that are reached over several frames. */
export interface Easing {
  /**
   * Returns what takes a tree, whose newest pose is in `data` from `at` on and has these coordinates, back to where it is on the way there.
   */
  easer(coordinates: Uint16Array): (tree: number, data: Float32Array, at: number) => void;
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

  easer(coordinates: Uint16Array) {
    const places = Array.from(this.coordinates, (one) => coordinates.indexOf(one));
    return (tree: number, data: Float32Array, at: number): void => {
      const share = this.share(tree);
      if (share === 1) return;
      for (let k = 0; k < places.length; k++) {
        const to = at + places[k];
        if (to < at) continue;
        const past = this.before[tree * places.length + k];
        data[to] = past + share * (data[to] - past);
      }
    };
  }

  /** Begins a frame, which takes no packets, one or several. */
  begin(): void {
    this.frame++;
  }

  /**
   * Takes a part of a packet; `at`: where it begins, which is moved behind it. `rows`: index here of each tree of the packet's
   * group, if that has not all trees.
   */
  take(
    packet: PosePacket,
    group: number,
    at: { row: number; near: number; far: number },
    rows: Uint32Array | null = null,
  ): void {
    const { near, all, far, periods } = packet.groups[group];
    if (all && !rows) {
      this.poses.set(packet.rows.subarray(at.row, at.row + this.poses.length));
      this.period.fill(0);
    } else this.takeNear(packet, near, all, at, rows);
    at.row += near * this.stride;
    if (!all) at.near += near;
    for (const [level, count] of far.entries()) {
      for (let k = at.far; k < at.far + count; k++)
        this.takeFar(packet, k, periods[level], rows ? rows[packet.far[k]] : packet.far[k]);
      at.far += count;
    }
  }

  private takeNear(
    packet: PosePacket,
    count: number,
    all: boolean,
    at: { row: number; near: number },
    rows: Uint32Array | null,
  ): void {
    const { poses, stride, period } = this;
    for (let k = 0; k < count; k++) {
      const listed = all ? k : packet.near[at.near + k];
      const tree = rows ? rows[listed] : listed;
      const [from, to] = [at.row + k * stride, tree * stride];
      for (let c = 0; c < stride; c++) poses[to + c] = packet.rows[from + c];
      period[tree] = 0;
    }
  }

  /** From what is displayed to the next pose. */
  private takeFar({ leading }: PosePacket, at: number, period: number, tree: number): void {
    const { poses, before, coordinates, stride, modes } = this;
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
