/** Power spectrum of a recorded signal (Welch's method). Pure. */
import { rootsOfUnity, transformRows } from "galewood/wind";

const SEGMENT_SAMPLES = 512;
const UNITY_ROOTS = rootsOfUnity(SEGMENT_SAMPLES);
const HANN_WINDOW = Float64Array.from(
  { length: SEGMENT_SAMPLES },
  (_, i) => 0.5 - 0.5 * UNITY_ROOTS.cosine[i],
);
const WINDOW_POWER = HANN_WINDOW.reduce((sum, value) => sum + value * value, 0);

export interface PowerSpectrum {
  readonly frequency_hz: Float64Array;
  /** One-sided density, (m/s)²/Hz. */
  readonly power: Float64Array;
}

/** Mean over half-overlapping Hann windows; null if there is less than one window of data. */
export function powerSpectrum(values: Float64Array, count: number, rate_hz: number): PowerSpectrum | null {
  if (count < SEGMENT_SAMPLES) return null;
  const half = SEGMENT_SAMPLES / 2;
  const power = new Float64Array(half - 1);
  const frequency_hz = Float64Array.from(power, (_, k) => ((k + 1) * rate_hz) / SEGMENT_SAMPLES);
  const re = new Float64Array(SEGMENT_SAMPLES);
  const im = new Float64Array(SEGMENT_SAMPLES);
  let segments = 0;
  for (let first = count - SEGMENT_SAMPLES; first >= 0; first -= half) {
    const part = values.subarray(first, first + SEGMENT_SAMPLES);
    const mean = part.reduce((sum, value) => sum + value, 0) / SEGMENT_SAMPLES;
    for (let i = 0; i < SEGMENT_SAMPLES; i++) re[i] = (part[i] - mean) * HANN_WINDOW[i];
    im.fill(0);
    transformRows(re, im, SEGMENT_SAMPLES, 1, UNITY_ROOTS, -1);
    for (let k = 0; k < power.length; k++) power[k] += re[k + 1] ** 2 + im[k + 1] ** 2;
    segments++;
  }
  const scale = 2 / (rate_hz * WINDOW_POWER * segments);
  return { frequency_hz, power: power.map((value) => value * scale) };
}

/** Weaker bins than this share of the strongest are gaps between the waves of a model, not turbulence. */
const MIN_POWER_RATIO = 1e-4;

/** A line of slope −5/3, fitted to the spectrum between two frequencies. */
export function kolmogorovLine(spectrum: PowerSpectrum, from_hz: number, to_hz: number): Float64Array {
  let sum = 0;
  let bins = 0;
  const floor = MIN_POWER_RATIO * Math.max(...spectrum.power);
  spectrum.frequency_hz.forEach((f, k) => {
    if (f < from_hz || f > to_hz || spectrum.power[k] <= floor) return;
    sum += Math.log(spectrum.power[k]) + (5 / 3) * Math.log(f);
    bins++;
  });
  const level = bins > 0 ? sum / bins : 0;
  return spectrum.frequency_hz.map((f) => Math.exp(level - (5 / 3) * Math.log(f)));
}
