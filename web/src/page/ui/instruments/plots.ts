/** The anemometer's two plots: wind speed and tip displacement over time, and the spectrum of the speed. */
import uPlot from "uplot";
import { make } from "../dom";
import { kolmogorovLine, powerSpectrum } from "./powerSpectrum";
import { RATE_HZ, type Recorder } from "./recorder";

const WIDTH_PX = 292;
const SHOWN_S = 20;
const SHOWN_HZ = [0.06, 6] as const;
const LINE_HZ = [0.3, 2] as const;
const INK_COLOUR = "#cfd3d2";
const GRID_STYLE = { stroke: "rgba(255,255,255,0.1)", width: 1 };
const AXIS_STYLE = { stroke: INK_COLOUR, grid: GRID_STYLE, ticks: GRID_STYLE, font: "10px sans-serif" };

const timeOptions: uPlot.Options = {
  width: WIDTH_PX,
  height: 118,
  legend: { show: false },
  cursor: { show: false },
  scales: {
    x: { time: false },
    speed: { range: (_, __, high) => [0, Math.max(2, high * 1.1)] },
    tip: { range: (_, __, high) => [0, Math.max(0.1, (high ?? 0) * 1.1)] },
  },
  axes: [
    { ...AXIS_STYLE, size: 26, gap: 3, values: (_, ticks) => ticks.map((tick) => `${tick} s`) },
    { ...AXIS_STYLE, scale: "speed", size: 40, values: (_, ticks) => ticks.map((tick) => `${tick}`) },
    { ...AXIS_STYLE, scale: "tip", side: 1, size: 48, stroke: "#8fd694", grid: { show: false } },
  ],
  series: [
    {},
    { label: "speed", scale: "speed", stroke: "#f2ad3f", width: 1.5 },
    { label: "tip", scale: "tip", stroke: "#8fd694", width: 1.2 },
  ],
};

const spectrumOptions: uPlot.Options = {
  width: WIDTH_PX,
  height: 138,
  legend: { show: false },
  cursor: { show: false },
  scales: {
    x: { time: false, distr: 3, range: [...SHOWN_HZ] },
    y: { distr: 3, range: (_, __, high) => powerRange(high) },
  },
  axes: [
    {
      ...AXIS_STYLE,
      size: 26,
      gap: 3,
      values: (_, ticks) => ticks.map((tick) => (isDecade(tick) ? `${tick} Hz` : "")),
    },
    {
      ...AXIS_STYLE,
      size: 46,
      values: (_, ticks) => ticks.map((tick) => (isDecade(tick) ? exponent(tick) : "")),
    },
  ],
  series: [
    {},
    { label: "power", stroke: "#f2ad3f", width: 1.2, points: { show: false } },
    { label: "−5/3", stroke: "#ffffff", width: 1, dash: [5, 4], points: { show: false } },
  ],
};

/** Shows 4.5 decades below the maximum; weaker power is negligible. */
function powerRange(highest: number): [number, number] {
  const top = 10 ** Math.ceil(Math.log10(Math.max(1e-3, highest || 1)));
  return [top * 10 ** -4.5, top];
}

const isDecade = (tick: number) => Number.isInteger(Math.round(Math.log10(tick) * 1e6) / 1e6);
const exponent = (tick: number) =>
  tick >= 0.01 && tick <= 100 ? `${tick}` : `1e${Math.round(Math.log10(tick))}`;

export class Plots {
  private readonly time: uPlot;
  private readonly spectrum: uPlot;

  constructor(paper: HTMLElement) {
    const [first, second] = [make("div"), make("div")];
    const name = (text: string) => make("p", text, "plot-name");
    paper.append(name("Wind speed (m/s, orange), tip (m, green)"), first);
    paper.append(name("Power spectrum ((m/s)²/Hz); dashed: slope −5/3"), second);
    this.time = new uPlot(timeOptions, [[], [], []], first);
    this.spectrum = new uPlot(spectrumOptions, [[], [], []], second);
  }

  show({ time_s, speed_m_s, tip_m, count }: Recorder): void {
    if (count < 2) return;
    const first = Math.max(0, count - SHOWN_S * RATE_HZ);
    const now = time_s[count - 1];
    const ago = Array.from(time_s.subarray(first, count), (t) => t - now);
    const tip = Array.from(tip_m.subarray(first, count), (value) => (Number.isFinite(value) ? value : null));
    this.time.setData([ago, [...speed_m_s.subarray(first, count)], tip]);
    const spectrum = powerSpectrum(speed_m_s, count, RATE_HZ);
    if (!spectrum) return;
    const line = kolmogorovLine(spectrum, ...LINE_HZ);
    const positive = Array.from(spectrum.power, (power) => (power > 0 ? power : null));
    this.spectrum.setData([[...spectrum.frequency_hz], positive, [...line]]);
  }
}
