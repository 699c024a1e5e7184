/**
 * Instances of one tree: position, orientation and size, and the stepping of each at its own time scale. Nothing is
 * allocated per frame.
 */
import { MAX_STEPS_PER_ADVANCE } from "../constants";
import type { PlaceGusts } from "../modal/placeGusts";
import type { CrownInstances } from "../wind/crown";

export type Numbers = Float64Array | Float32Array;

/** Common part of both methods; r modes. `room`: pose buffers to use instead of allocating them. */
export abstract class TreeInstances {
  /** [count, r] displayed pose, interpolated between the last two steps. */
  readonly q: Float32Array;
  /** Position of each tree (m), for the wind. */
  readonly x: Float32Array;
  readonly z: Float32Array;
  /** [count, r or more] pose after the last step and after the previous one. */
  protected readonly now: Numbers;
  protected readonly before: Numbers;
  private readonly phase: Float64Array;
  private readonly span: Float32Array;
  private readonly turn: Float32Array;
  protected readonly size: Float32Array;
  /** Where the trees stand; the arrays of the instances, not copies. */
  protected readonly standing: CrownInstances;
  /** The gusts within the crowns in the present frame. */
  protected gusts: PlaceGusts | null = null;
  /** The pressure in the frame of the last tree asked for. */
  protected readonly localPressure = { px: 0, pz: 0 };

  constructor(
    readonly count: number,
    protected readonly r: number,
    protected readonly dt: number,
    room: { now: Numbers; before: Numbers } | null = null,
  ) {
    this.q = new Float32Array(count * r);
    this.x = new Float32Array(count);
    this.z = new Float32Array(count);
    this.now = room?.now ?? new Float64Array(count * r);
    this.before = room?.before ?? new Float64Array(count * r);
    this.phase = new Float64Array(count);
    this.span = new Float32Array(count).fill(1);
    this.turn = new Float32Array(count * 2);
    for (let i = 0; i < count; i++) this.turn[2 * i] = 1;
    this.size = new Float32Array(count).fill(1);
    this.standing = { x: this.x, z: this.z, turn: this.turn, size: this.size };
  }

  /** Advances tree i by one table step under a pressure (Pa) in its own frame. */
  protected abstract step(i: number, px: number, pz: number): void;
  /** Writes the pose of tree i, interpolated between the last two steps (`part` from 0 to 1). */
  protected abstract show(i: number, part: number): void;

  /** Sets position, yaw and scale of each tree; their state is kept. */
  setTrees(
    x: ArrayLike<number>,
    z: ArrayLike<number>,
    yaw: ArrayLike<number>,
    scale: ArrayLike<number>,
  ): void {
    this.x.set(x);
    this.z.set(z);
    this.size.set(scale);
    for (let i = 0; i < this.count; i++) {
      // Rounded to float32, because the last bit of a cosine differs between platforms.
      this.turn[2 * i] = Math.cos(Math.fround(yaw[i]));
      this.turn[2 * i + 1] = Math.sin(Math.fround(yaw[i]));
    }
  }

  /** Copies the state of tree `row` of another forest of this table to tree i. */
  protected takeOver(i: number, from: TreeInstances, row: number): void {
    this.phase[i] = from.phase[row];
    this.span[i] = from.span[row];
    const width = this.now.length / this.count;
    this.now.set(from.now.subarray(row * width, (row + 1) * width), i * width);
    this.before.set(from.before.subarray(row * width, (row + 1) * width), i * width);
  }

  /** Turns a world pressure into the frame of tree i. */
  protected rotatePressure(i: number, x: number, z: number): void {
    const c = this.turn[2 * i];
    const s = this.turn[2 * i + 1];
    this.localPressure.px = c * x - s * z;
    this.localPressure.pz = s * x + c * z;
  }

  /**
   * Advances by dt seconds under world pressures (Pa). A tree s times as large sways s times slower. Trees of the modal
   * method also feel `gusts` within their crowns.
   */
  advance(
    dtS: number,
    pressureX: ArrayLike<number>,
    pressureZ: ArrayLike<number>,
    gusts: PlaceGusts | null = null,
  ): void {
    this.gusts = gusts;
    for (let i = 0; i < this.count; i++) this.advanceOne(i, dtS, pressureX[i], pressureZ[i]);
    this.gusts = null;
  }

  protected advanceOne(i: number, dtS: number, pressureX: number, pressureZ: number): void {
    this.rotatePressure(i, pressureX, pressureZ);
    this.show(i, this.advanceBy(i, dtS, 1));
  }

  /**
   * Advances a tree by dt seconds in steps of `length` table steps, under `localPressure`. Returns how much of the last step
   * is displayed, 0..1.
   */
  protected advanceBy(i: number, dtS: number, length: number): number {
    const { px, pz } = this.localPressure;
    let span = this.span[i];
    let phase = this.phase[i] + dtS / this.dt / this.size[i];
    for (let steps = 0; phase >= span && steps < MAX_STEPS_PER_ADVANCE; steps++) {
      this.step(i, px, pz);
      phase -= span;
      span = length;
    }
    phase -= span * Math.floor(phase / span);
    this.span[i] = span;
    this.phase[i] = phase;
    return phase / span;
  }
}
