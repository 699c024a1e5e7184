/**
 * Prints how far the tip of a blade of grass of 0.4 m moves in the winds of the page, one line each: opening view, Breeze, Gusts,
 * Storm front; root mean square about the mean and its part above 1 Hz, cm, mean of 20 places, 40 s. `npm run --silent grass-motion`,
 * which docs/examples/motion_figures.py runs.
 */
import { meanVelocity_m_s, PRESETS, type WindDocument, WindField } from "galewood/wind";
import { DEFAULTS } from "../src/page/settings/settings";
import { bladeLean_rad, grassLean_rad, sweepDown } from "../src/scene/ground/groundWind";

const BLADE_M = 0.4;
const FRAMES_HZ = 30;
const SPAN_S = 40;
const FAST_HZ = 1;
const PLACE_COUNT = 20;
const WINDS: readonly WindDocument[] = [
  DEFAULTS.wind,
  PRESETS.breeze,
  PRESETS["autumn-gusts"],
  PRESETS["storm-front"],
];

/** Power of the frequencies above `from_hz` of a Hann window of values about their mean. */
function power(values: Float64Array, from_hz: number): number {
  const n = values.length;
  const mean = values.reduce((sum, x) => sum + x, 0) / n;
  let all = 0;
  for (let k = Math.floor((from_hz * n) / FRAMES_HZ) + 1; k <= n / 2; k++) {
    let [re, im] = [0, 0];
    for (let i = 0; i < n; i++) {
      const weighed = (values[i] - mean) * Math.sin((Math.PI * i) / (n - 1)) ** 2;
      re += weighed * Math.cos((2 * Math.PI * k * i) / n);
      im += weighed * Math.sin((2 * Math.PI * k * i) / n);
    }
    all += re * re + im * im;
  }
  return all;
}

for (const wind of WINDS) {
  const field = new WindField(wind);
  const x = Float64Array.from({ length: PLACE_COUNT }, (_, k) => 7 * (k % 5));
  const z = Float64Array.from({ length: PLACE_COUNT }, (_, k) => 11 * Math.floor(k / 5));
  const out = [new Float64Array(PLACE_COUNT), new Float64Array(PLACE_COUNT)];
  const frames = SPAN_S * FRAMES_HZ;
  const tips = Array.from({ length: PLACE_COUNT }, () => [
    new Float64Array(frames),
    new Float64Array(frames),
  ]);
  for (let frame = 0; frame < frames; frame++) {
    const time_s = frame / FRAMES_HZ;
    const moment = field.at(time_s);
    field.velocity(x, z, moment, out[0], out[1]);
    sweepDown(meanVelocity_m_s(moment.wind), out[0], out[1]);
    for (const [k, tip] of tips.entries()) {
      const speed = Math.hypot(out[0][k], out[1][k]);
      const reach_m = BLADE_M * Math.sin(bladeLean_rad(grassLean_rad(speed), k / PLACE_COUNT, time_s));
      for (const axis of [0, 1]) tip[axis][frame] = (reach_m * out[axis][k]) / Math.max(speed, 1e-9);
    }
  }
  const squares = tips.map(([along, across]) =>
    [along, across].reduce((sum, values) => {
      const mean = values.reduce((a, b) => a + b, 0) / frames;
      return sum + values.reduce((a, b) => a + (b - mean) ** 2, 0) / frames;
    }, 0),
  );
  const shares = tips.map(
    ([along, across]) =>
      (power(along, FAST_HZ) + power(across, FAST_HZ)) / Math.max(1e-30, power(along, 0) + power(across, 0)),
  );
  const mean = (values: number[]) => (100 * values.reduce((a, b) => a + b, 0)) / PLACE_COUNT;
  const total_cm = mean(squares.map(Math.sqrt));
  const fast_cm = mean(squares.map((square, k) => Math.sqrt(square * shares[k])));
  console.log(total_cm.toFixed(3), fast_cm.toFixed(3));
}
