/**
 * Motion of trees that are not simulated: the first sway mode of each, a damped oscillator along x and z with the
 * frequency, damping and compliance of its species' table, driven by the forest's wind at its place. Pure.
 */

import type { FirstSway } from "galewood/client";
import { dynamicPressure, STREAMLINING_SPEED_M_S } from "galewood/wind";

/** Largest displacement of the tip relative to the height. */
const MOST_SWAY = 0.22;
/** Floats per tree in `tips`: displacement x, z in the world frame, m. */
export const TIP_FLOATS = 2;
/** Oscillators share their step with others of nearly the same size. */
const SIZES_PER_UNIT = 12;

/** Exact step of y'' + 2ζω y' + ω² y = 0 over dt: [y, y'] becomes [[a, b], [c, d]] · [y, y']. */
export function freeStep(
  frequency_hz: number,
  damping: number,
  dt_s: number,
): readonly [number, number, number, number] {
  const omega = 2 * Math.PI * frequency_hz;
  const decay = Math.min(0.95, damping) * omega;
  const damped = Math.sqrt(omega * omega - decay * decay);
  const fall = Math.exp(-decay * dt_s);
  const cos = Math.cos(damped * dt_s);
  const sin = Math.sin(damped * dt_s) / damped;
  return [fall * (cos + decay * sin), fall * sin, -fall * omega * omega * sin, fall * (cos - decay * sin)];
}

/** Factor of a static displacement of the tip that reduces it smoothly towards the largest one. */
function softened(push_m: number, most_m: number): number {
  return 1 / (1 + Math.abs(push_m) / most_m);
}

/**
 * Damping ratio of the air: drag p(U - v) that bends a body of stiffness k by x = p(U) / k opposes the motion by p'(U) v.
 * p grows with the power n of the speed: p' = n p / U, hence a ratio of n ω x / 2 U.
 */
export function airDamping({ frequency_hz, tip_m_pa, streamlined }: FirstSway, speed_m_s: number): number {
  if (speed_m_s < 1e-3) return 0;
  const power = speed_m_s > STREAMLINING_SPEED_M_S ? streamlined : 2;
  return (power * Math.PI * frequency_hz * tip_m_pa * dynamicPressure(speed_m_s, streamlined)) / speed_m_s;
}

export class Sway {
  /** [trees, 2] newest displacement of each tip. */
  readonly tips: Float32Array;
  private readonly speeds: Float32Array;
  private readonly sizes: Uint16Array;

  /** `scales`: size of each tree relative to its species. */
  constructor(
    private readonly sway: FirstSway,
    private readonly height_m: number,
    private readonly scales: Float32Array,
  ) {
    this.tips = new Float32Array(TIP_FLOATS * scales.length);
    this.speeds = new Float32Array(TIP_FLOATS * scales.length);
    this.sizes = Uint16Array.from(scales, (scale) => Math.max(1, Math.round(SIZES_PER_UNIT * scale)));
  }

  /** Puts trees to rest in the pressure (Pa) at each of them. */
  settle(trees: ArrayLike<number>, pressureX: ArrayLike<number>, pressureZ: ArrayLike<number>): void {
    const { tips, speeds } = this;
    for (let i = 0; i < trees.length; i++) {
      const at = TIP_FLOATS * trees[i];
      const gain = this.gain_m_pa(trees[i], pressureX[i], pressureZ[i]);
      tips[at] = gain * pressureX[i];
      tips[at + 1] = gain * pressureZ[i];
      speeds[at] = speeds[at + 1] = 0;
    }
  }

  /**
   * Advances trees under the pressure (Pa) at each of them, constant over the step. `meanSpeed_m_s`: mean wind speed, which damps the
   * motion.
   */
  advance(
    dt_s: number,
    trees: ArrayLike<number>,
    pressureX: ArrayLike<number>,
    pressureZ: ArrayLike<number>,
    meanSpeed_m_s: number,
  ): void {
    const steps: (ReturnType<typeof freeStep> | undefined)[] = [];
    const { frequency_hz } = this.sway;
    const damping = this.sway.damping + airDamping(this.sway, meanSpeed_m_s);
    for (let i = 0; i < trees.length; i++) {
      const tree = trees[i];
      const size = this.sizes[tree];
      // A larger tree of the same shape sways more slowly, in inverse proportion to its size.
      const step = steps[size] ?? freeStep((frequency_hz * SIZES_PER_UNIT) / size, damping, dt_s);
      steps[size] = step;
      const gain = this.gain_m_pa(tree, pressureX[i], pressureZ[i]);
      this.swing(TIP_FLOATS * tree, gain * pressureX[i], step);
      this.swing(TIP_FLOATS * tree + 1, gain * pressureZ[i], step);
    }
  }

  /** Static displacement of the tip of a tree per pressure (Pa), which falls as that grows. */
  private gain_m_pa(tree: number, x_pa: number, z_pa: number): number {
    const per_pa = this.sway.tip_m_pa * this.scales[tree];
    const most_m = MOST_SWAY * this.height_m * this.scales[tree];
    // The square root, because Math.hypot takes several times as long.
    return per_pa * softened(per_pa * Math.sqrt(x_pa * x_pa + z_pa * z_pa), most_m);
  }

  /** Goes on from the motion of another one, of the same trees. */
  adopt(before: Sway): void {
    this.tips.set(before.tips);
    this.speeds.set(before.speeds);
  }

  /** Steps one coordinate about its static displacement. */
  private swing(at: number, rest_m: number, [a, b, c, d]: readonly number[]): void {
    const { tips, speeds } = this;
    const off = tips[at] - rest_m;
    const speed = speeds[at];
    tips[at] = rest_m + a * off + b * speed;
    speeds[at] = c * off + d * speed;
  }
}
