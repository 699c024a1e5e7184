/** Accumulates the deltas of the server's frames to poses. Pure. */

import { poseStride } from "../../core/motion/poseStride";
import type { Frame } from "../../core/wire/wire";

export interface GroupShape {
  readonly count: number;
  /** The table's modes.scale, one per mode. */
  readonly scale: Float32Array;
}

export class PoseSum {
  private readonly units: Int32Array[];
  private quanta: number[];
  private tick: number | null = null;

  constructor(private readonly shapes: readonly GroupShape[]) {
    this.units = shapes.map(({ count, scale }) => new Int32Array(count * scale.length));
    this.quanta = shapes.map(() => 1);
  }

  /** Whether a frame matches the shape of this forest. */
  fits({ groups }: Frame): boolean {
    return (
      groups.length === this.shapes.length &&
      groups.every((rows, g) => rows.values.length === this.units[g].length)
    );
  }

  /** Adds a frame; false if it belongs to another forest, or is a delta to a tick other than the current one. */
  add(frame: Frame): boolean {
    if (!this.fits(frame) || (frame.base !== null && frame.base !== this.tick)) return false;
    this.tick = frame.tick;
    this.quanta = frame.groups.map(({ quantum }) => quantum);
    for (const [g, { values }] of frame.groups.entries()) {
      const sum = this.units[g];
      if (frame.base === null) sum.set(values);
      else for (let i = 0; i < sum.length; i++) sum[i] += values[i];
    }
    return true;
  }

  /** Writes the poses into pose buffers. */
  write(out: readonly Float32Array[]): void {
    for (const [g, { count, scale }] of this.shapes.entries()) {
      const modes = scale.length;
      const quantum = this.quanta[g];
      const stride = poseStride(modes);
      for (let tree = 0; tree < count; tree++) {
        for (let k = 0; k < modes; k++)
          out[g][tree * stride + k] = this.units[g][tree * modes + k] * quantum * scale[k];
      }
    }
  }
}
