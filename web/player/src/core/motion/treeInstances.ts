/**
 * Instances of one tree: position, orientation and size, and the stepping of each at its own time scale. Nothing is
 * allocated per frame.
 */
import { MAX_STEPS_PER_ADVANCE } from "../constants";
import type { PlaceGusts } from "../modal/placeGusts";
import type { CrownInstances } from "../wind/crown";

export type Numbers = Float64Array | Float32Array;

/** What many forests with few trees each would otherwise read from a place of its own. */
const LOCAL_PRESSURE = { px: 0, pz: 0 };

/** Common part of both methods; r modes. */
export abstract class TreeInstances {
  /** [count, r] displayed pose, interpolated between the last two steps. */
  readonly q: Float32Array;
  /** Position of each tree (m), for the wind. */
  readonly x: Float32Array;
  readonly z: Float32Array;
  /** Numbers of a tree in `states`. */
  protected readonly width: number;
  /** Views of `states`: the pose after the last step, which a row holds from here on, and after the previous one. */
  protected readonly now: Numbers;
  protected readonly before: Numbers;
  /** [count, 2] table steps that are due of the present step, and its length in table steps. */
  private readonly clock: Float64Array;
  /** [count, 3] cosine and sine of the yaw, scale. */
  private readonly turn: Float32Array;
  /** Where the trees stand; the arrays of the instances, not copies. */
  protected readonly standing: CrownInstances;
  /** The gusts within the crowns in the present frame. */
  protected gusts: PlaceGusts | null = null;
  /** The pressure in the frame of the last tree asked for. */
  protected readonly localPressure = LOCAL_PRESSURE;

  /** `states`: [count, …] all that changes of the trees; each row has two poses from `posesAt` on. */
  constructor(
    readonly count: number,
    protected readonly r: number,
    protected readonly dt: number,
    protected readonly states: Numbers = new Float64Array(2 * count * r),
    posesAt = 0,
  ) {
    this.q = new Float32Array(count * r);
    this.x = new Float32Array(count);
    this.z = new Float32Array(count);
    this.width = states.length / count;
    this.now = states.subarray(posesAt);
    this.before = this.now.subarray((this.width - posesAt) / 2);
    this.clock = Float64Array.from({ length: 2 * count }, (_, k) => k % 2);
    this.turn = Float32Array.from({ length: 3 * count }, (_, k) => (k % 3 === 1 ? 0 : 1));
    this.standing = { x: this.x, z: this.z, turn: this.turn };
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
    for (let i = 0; i < this.count; i++) {
      // Rounded to float32, because the last bit of a cosine differs between platforms.
      this.turn[3 * i] = Math.cos(Math.fround(yaw[i]));
      this.turn[3 * i + 1] = Math.sin(Math.fround(yaw[i]));
      this.turn[3 * i + 2] = scale[i];
    }
  }

  /** Scale of a tree. */
  protected sizeOf(i: number): number {
    return this.turn[3 * i + 2];
  }

  /** Copies the state of tree `row` of another forest of this table to tree i. */
  protected takeOver(i: number, from: TreeInstances, row: number): void {
    this.clock.set(from.clock.subarray(2 * row, 2 * row + 2), 2 * i);
    const { width } = this;
    this.states.set(from.states.subarray(row * width, (row + 1) * width), i * width);
  }

  /** Turns a world pressure into the frame of tree i. */
  protected rotatePressure(i: number, x: number, z: number): void {
    const c = this.turn[3 * i];
    const s = this.turn[3 * i + 1];
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
    const { clock } = this;
    let span = clock[2 * i + 1];
    let phase = clock[2 * i] + dtS / this.dt / this.sizeOf(i);
    for (let steps = 0; phase >= span && steps < MAX_STEPS_PER_ADVANCE; steps++) {
      this.step(i, px, pz);
      phase -= span;
      span = length;
    }
    phase -= span * Math.floor(phase / span);
    clock[2 * i + 1] = span;
    clock[2 * i] = phase;
    return phase / span;
  }
}
