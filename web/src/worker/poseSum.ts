/** Sums the deltas of the server's frames back to poses. Pure. */
import { poseStride } from "../nodeLayout";
import type { Frame } from "../wire";

export interface GroupShape {
  readonly count: number;
  /** Metres^... per integer unit, one per mode: the table's modes.scale. */
  readonly scale: Float32Array;
}

export class PoseSum {
  private readonly units: Int32Array[];
  private started = false;

  constructor(private readonly shapes: readonly GroupShape[]) {
    this.units = shapes.map(({ count, scale }) => new Int32Array(count * scale.length));
  }

  /** Takes a frame in; false if it is a delta before any key frame, or for another forest. */
  add(frame: Frame): boolean {
    const fits =
      frame.groups.length === this.shapes.length &&
      frame.groups.every((rows, g) => rows.values.length === this.units[g].length);
    if (!fits || (!frame.key && !this.started)) return false;
    this.started = true;
    for (const [g, { values }] of frame.groups.entries()) {
      const sum = this.units[g];
      if (frame.key) sum.set(values);
      else for (let i = 0; i < sum.length; i++) sum[i] += values[i];
    }
    return true;
  }

  /** Writes the poses as rows for the screen. */
  write(out: readonly Float32Array[]): void {
    for (const [g, { count, scale }] of this.shapes.entries()) {
      const modes = scale.length;
      const stride = poseStride(modes);
      for (let tree = 0; tree < count; tree++) {
        for (let k = 0; k < modes; k++)
          out[g][tree * stride + k] = this.units[g][tree * modes + k] * scale[k];
      }
    }
  }
}
