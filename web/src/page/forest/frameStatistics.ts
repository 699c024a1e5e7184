/** Running means of the cost of a frame, and when the next one is due. Pure. */

/** Figures of the panel, refreshed several times per second. */
export interface Statistics {
  framesPerSecond: number;
  frame_ms: number;
  script_ms: number;
  lookup_ms: number;
  trees: number;
  triangles: number;
  drawCalls: number;
  stream: string;
  latency: string;
  frameAge: string;
}

/** Longer pauses, for example of a hidden tab, are skipped. */
export const MAX_FRAME_S = 0.25;
const NEWEST_SHARE = 0.08;
/** Displays refresh a little early or late; a limited frame may come this much early. */
const EARLY_MS = 1;

/** Whether the next frame may be drawn, this long after the last one. */
export const isFrameDue = (since_ms: number, limit_hz: number): boolean =>
  since_ms >= 1000 / limit_hz - EARLY_MS;

export class FrameStatistics {
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

  /** Adds a frame: time since the previous frame, and script time. */
  count(frame_ms: number, script_ms: number): void {
    const { statistics } = this;
    const first = statistics.frame_ms === 0;
    statistics.frame_ms += (first ? 1 : NEWEST_SHARE) * (frame_ms - statistics.frame_ms);
    statistics.script_ms += (first ? 1 : NEWEST_SHARE) * (script_ms - statistics.script_ms);
    statistics.framesPerSecond = statistics.frame_ms > 0 ? 1000 / statistics.frame_ms : 0;
  }

  publish(figures: Partial<Statistics>): void {
    Object.assign(this.statistics, figures);
  }
}
