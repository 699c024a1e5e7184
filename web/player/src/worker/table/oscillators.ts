/** Natural frequencies of a table's oscillators. Pure. */

/** Numbers per oscillator in `modal.step`: r00 − 1, r01, r10, r11 − 1, s0, s1. */
const STEP_ROW_LENGTH = 6;

/**
 * One step of a damped oscillator has the eigenvalues exp((−ζω ± iω√(1 − ζ²)) dt): trace and determinant of
 * `modal.step` give the damped frequency of each.
 */
export function oscillatorFrequencies_hz(step: Float32Array, dt_s: number): Float32Array<ArrayBuffer> {
  return Float32Array.from({ length: step.length / STEP_ROW_LENGTH }, (_, k) => {
    const [a, b, c, d] = step.subarray(k * STEP_ROW_LENGTH, k * STEP_ROW_LENGTH + 4);
    const [r00, r11] = [1 + a, 1 + d];
    const cosine = (r00 + r11) / (2 * Math.sqrt(r00 * r11 - b * c));
    return Math.acos(Math.min(1, Math.max(-1, cosine))) / (2 * Math.PI * dt_s);
  });
}
