/** Running means of what a frame costs. Pure. */
import type { Statistics } from "./ui/panel";

const SHARE = 0.08;

export class Meter {
  readonly statistics: Statistics = {
    framesPerSecond: 0,
    frame_ms: 0,
    script_ms: 0,
    lookup_ms: 0,
    trees: 0,
    triangles: 0,
    drawCalls: 0,
    stream: "off",
    latency: "–",
    frameAge: "–",
  };

  /** One frame: time since the frame before, and the main thread's own part of it. */
  count(frame_ms: number, script_ms: number): void {
    const { statistics } = this;
    const first = statistics.frame_ms === 0;
    statistics.frame_ms += (first ? 1 : SHARE) * (frame_ms - statistics.frame_ms);
    statistics.script_ms += (first ? 1 : SHARE) * (script_ms - statistics.script_ms);
    statistics.framesPerSecond = statistics.frame_ms > 0 ? 1000 / statistics.frame_ms : 0;
  }

  publish(figures: Partial<Statistics>): void {
    Object.assign(this.statistics, figures);
  }
}
