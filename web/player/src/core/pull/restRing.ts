/** How the part of a pull that the modes do not show rings down after a release. Pure. */
import type { RestResponse } from "./pointResponse";

/** Assumed: damping ratio of the motion of a single branch. */
const DAMPING_RATIO = 0.07;
const SLOWEST_HZ = 1;
const FASTEST_HZ = 12;
/** The motion ends when its amplitude has fallen to this share. */
const END_SHARE = 0.01;

/** Rayleigh's quotient of the response to a force: angular frequency, 1/s. */
export function restFrequency(rest: RestResponse, force_N: ArrayLike<number>): number {
  const form = (m: Float64Array) => {
    let sum = 0;
    for (let at = 0; at < 9; at++) sum += force_N[Math.floor(at / 3)] * m[at] * force_N[at % 3];
    return sum;
  };
  const [held, mass] = [form(rest.yields), form(rest.inertia)];
  const omega = mass > 0 && held > 0 ? Math.sqrt(held / mass) : 0;
  return Math.min(2 * Math.PI * FASTEST_HZ, Math.max(2 * Math.PI * SLOWEST_HZ, omega));
}

/** Share of the displacement at a time after the release; null when it has died down. */
export function ringShare(omega: number, age_s: number): number | null {
  const left = Math.exp(-DAMPING_RATIO * omega * age_s);
  return left < END_SHARE ? null : left * Math.cos(omega * Math.sqrt(1 - DAMPING_RATIO ** 2) * age_s);
}
