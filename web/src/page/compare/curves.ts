/** Displacement and errors over time in % of tree height, on a logarithmic axis, with a playback cursor. */
import uPlot from "uplot";
import type { Tracks } from "./tracks";
import { percent } from "./words";

const INK_COLOUR = "#cfd3d2";
const GRID_STYLE = { stroke: "rgba(255,255,255,0.1)", width: 1 };
const AXIS_STYLE = { stroke: INK_COLOUR, grid: GRID_STYLE, ticks: GRID_STYLE, font: "11px sans-serif" };
const DECADES = [1e-3, 100] as const;

const COLOURS = { sway: "#9aa6ab", modal: "#8fd694", paper: "#f2ad3f" } as const;

const line = (label: string, stroke: string, dash?: number[]) => ({
  label,
  stroke,
  width: 1.6,
  dash,
  points: { show: false },
  value: (_: uPlot, value: number | null) => (value === null ? "–" : `${percent(value)} %`),
});

export class Curves {
  private readonly plot: uPlot;
  private readonly resized: ResizeObserver;
  private now_s = 0;

  /** `seek` is called with the time of a click or tap. */
  constructor(paper: HTMLElement, seek: (time_s: number) => void) {
    this.plot = new uPlot(this.options(paper), [[], [], [], [], []], paper);
    this.plot.over.addEventListener("pointerdown", (event) => seek(this.plot.posToVal(event.offsetX, "x")));
    this.resized = new ResizeObserver(() =>
      this.plot.setSize({ width: paper.clientWidth, height: this.height(paper) }),
    );
    this.resized.observe(paper);
  }

  private height(paper: HTMLElement): number {
    return Math.max(140, Math.min(300, paper.clientWidth * 0.42));
  }

  private options(paper: HTMLElement): uPlot.Options {
    return {
      width: paper.clientWidth || 320,
      height: this.height(paper),
      legend: { show: true, live: true },
      cursor: { drag: { x: false, y: false } },
      scales: { x: { time: false }, y: { distr: 3, range: [...DECADES] } },
      axes: [
        { ...AXIS_STYLE, size: 28, values: (_, ticks) => ticks.map((tick) => `${tick} s`) },
        {
          ...AXIS_STYLE,
          size: 68,
          values: (_, ticks) => ticks.map((tick) => (isDecade(tick) ? `${tick} %` : "")),
        },
      ],
      series: [
        { label: "time", value: (_, value) => (value === null ? "–" : `${value.toFixed(1)} s`) },
        line("displacement", COLOURS.sway),
        line("error in gusts, modal", COLOURS.modal),
        line("error in a uniform wind, modal", COLOURS.modal, [3, 3]),
        line("error in gusts, paper's search", COLOURS.paper),
      ],
      hooks: { draw: [(plot) => this.drawNow(plot)] },
    };
  }

  private drawNow({ ctx, bbox, valToPos }: uPlot): void {
    const left = valToPos.call(this.plot, this.now_s, "x", true);
    ctx.save();
    ctx.strokeStyle = "rgba(255,255,255,0.7)";
    ctx.beginPath();
    ctx.moveTo(left, bbox.top);
    ctx.lineTo(left, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }

  show({ frames, dt_s, gusts, uniform }: Tracks): void {
    const time_s = Array.from({ length: frames }, (_, frame) => (frame + 1) * dt_s);
    const inPercent = (share: readonly number[]) =>
      share.map((value) => Math.min(Math.max(100 * value, DECADES[0]), DECADES[1]));
    const { modal, paper } = gusts.error;
    const drawn = [gusts.sway, modal.max, uniform.error.modal.max, paper?.max ?? []];
    this.plot.setData([time_s, ...drawn.map(inPercent)]);
  }

  /** Moves the cursor to a time. */
  at(time_s: number): void {
    this.now_s = time_s;
    this.plot.redraw(false);
  }
}

const isDecade = (tick: number) => Number.isInteger(Math.round(Math.log10(tick) * 1e6) / 1e6);
