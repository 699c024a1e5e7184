/** The anemometer: its position, its measurements and their plots. */
import type { WindField } from "galewood/wind";
import { loadPart, withServer } from "../../server/connected";
import { make, makeButton } from "../dom";
import type { Plots } from "./plots";
import { KEPT_SAMPLES, RATE_HZ, Recorder } from "./recorder";

const PLOT_EVERY_MS = 300;

export class Anemometer {
  readonly element = make("section", "", "anemometer");
  readonly recorder = new Recorder();
  place: { x: number; z: number } | null = null;
  speed_m_s = 0;
  private readonly reading = make("p", "", "anemometer-reading");
  private readonly paper = make("div", "", "plots");
  private plots: Plots | null = null;
  private readonly x = new Float64Array(1);
  private readonly z = new Float64Array(1);
  private readonly velocityX = new Float64Array(1);
  private readonly velocityZ = new Float64Array(1);
  private plotted_ms = 0;

  constructor(remove: () => void) {
    const close = makeButton("Remove", remove);
    this.element.append(make("h3", "Anemometer"), this.reading, this.paper, close);
    this.element.hidden = true;
  }

  /** Places the anemometer. The past wind is evaluated at once, unless the model is stepped in time. */
  placeAt(x: number, z: number, field: WindField, time_s: number): void {
    this.place = { x, z };
    this.x[0] = x;
    this.z[0] = z;
    this.recorder.clear();
    this.element.hidden = false;
    void withServer("The plots are not shown.", () => this.loadPlots());
    this.recordPast(field, time_s);
  }

  private recordPast(field: WindField, time_s: number): void {
    const { before, wind, since_s } = field.state;
    if (wind.model === "navier-stokes") return;
    const first_s = before === wind ? Number.NEGATIVE_INFINITY : since_s;
    for (let k = KEPT_SAMPLES; k > 0; k--) {
      const then_s = time_s - k / RATE_HZ;
      if (then_s >= first_s) this.recorder.push(then_s, this.speedAt(field, then_s), Number.NaN);
    }
  }

  /** Loads the plotting library on first use. */
  private async loadPlots(): Promise<void> {
    if (this.plots) return;
    const drawn = await loadPart(() => import("./plots"));
    this.plots ??= new drawn.Plots(this.paper);
  }

  remove(): void {
    this.place = null;
    this.element.hidden = true;
  }

  private speedAt(field: WindField, time_s: number): number {
    field.velocity(this.x, this.z, field.at(time_s), this.velocityX, this.velocityZ);
    return Math.hypot(this.velocityX[0], this.velocityZ[0]);
  }

  /** Records samples up to a time; `tip_m` is the current tip displacement of the observed tree. */
  measure(field: WindField, time_s: number, tip_m: number): void {
    if (!this.place) return;
    this.recorder.advance(time_s, (at_s) => ({ speed_m_s: this.speedAt(field, at_s), tip_m }));
    this.speed_m_s = this.speedAt(field, time_s);
  }

  /** Redraws the plots a few times per second. */
  draw(now_ms: number): void {
    if (!this.place || now_ms - this.plotted_ms < PLOT_EVERY_MS) return;
    this.plotted_ms = now_ms;
    const { x, z } = this.place;
    const tip_m = this.recorder.tip_m[this.recorder.count - 1] || 0;
    this.reading.textContent =
      `${this.speed_m_s.toFixed(1)} m/s at x = ${x.toFixed(0)} m, z = ${z.toFixed(0)} m; ` +
      `tip: ${(100 * tip_m).toFixed(0)} cm`;
    this.plots?.show(this.recorder);
  }
}
