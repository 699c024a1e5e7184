/** First sway mode of a table, for trees that only sway in the background. Pure. */

import { tipNode } from "../../core/motion/tip";
import type { Table } from "../../core/table/table";
import type { FirstSway } from "../protocol";

/** Oscillators that may be the first sway along x and z. */
const FIRST_SWAY_OSCILLATORS = 2;
const LEAST_HZ = 0.02;

/** Frequency, damping ratio and static response to a unit force of one oscillator, from its step of `dt_s`. */
export function oscillatorOf(step: ArrayLike<number>, dt_s: number) {
  const [r00, r01, r10, r11, s0, s1] = [1 + step[0], step[1], step[2], 1 + step[3], step[4], step[5]];
  const product = Math.max(1e-9, r00 * r11 - r01 * r10); // e^(−2ζω dt)
  const decay = -Math.log(product) / (2 * dt_s);
  const damped = Math.acos(Math.min(1, Math.max(-1, (r00 + r11) / (2 * Math.sqrt(product))))) / dt_s;
  const omega = Math.hypot(decay, damped);
  // The state that the step keeps under a unit force.
  const at_rest = ((1 - r11) * s0 + r01 * s1) / ((1 - r00) * (1 - r11) - r01 * r10);
  return { frequency_hz: omega / (2 * Math.PI), damping: decay / omega, at_rest };
}

/** Frequency and damping of the slowest oscillator, and the static displacement of the tip per Pa. */
export function firstSwayOf(table: Table, stride: number, basis: Float32Array): FirstSway {
  const { modes, dt_s, streamlined_exponent: streamlined } = table.metadata;
  const { step, load, shown } = table.modal;
  const count = step.length / 6;
  const oscillators = Array.from({ length: count }, (_, k) =>
    oscillatorOf(step.subarray(6 * k, 6 * k + 6), dt_s),
  );
  const first = oscillators
    .slice(0, FIRST_SWAY_OSCILLATORS)
    .sort((a, b) => a.frequency_hz - b.frequency_hz)[0];
  const node = tipNode({ stride, modes, basis });
  let tip_m_pa = 0;
  for (const [axis, along] of [
    [0, 0],
    [2, 1],
  ]) {
    let sum = 0;
    oscillators.forEach(({ at_rest }, k) => {
      sum += basis[(node * 3 + axis) * stride + k] * shown[k] * at_rest * load[2 * k + along];
    });
    tip_m_pa += 0.5 * Math.abs(sum);
  }
  return {
    frequency_hz: Math.max(LEAST_HZ, first.frequency_hz),
    damping: first.damping,
    tip_m_pa,
    streamlined,
  };
}
