/** Writes the figures of the panel, the status line and the summary of the forest. */

import type { Connection } from "galewood/client";
import type { Forest } from "../scene/forest";
import type { Stage } from "../scene/stage";
import type { ForestClient } from "./forestClient";
import type { FrameStatistics } from "./frameStatistics";
import type { Settings } from "./settings/settings";
import { element, make } from "./ui/dom";
import { type ListedTrees, statusLine, summary } from "./ui/words";

/** Replaces a text only if it differs: screen readers announce every replacement. */
function write(place: HTMLElement, text: string): void {
  if (place.textContent !== text) place.textContent = text;
}

export class StatusReport {
  private readonly words = make("span");
  private readonly again = make("button", "Try now", "try-now");

  /** `retry` tries lost connections at once. */
  constructor(
    private readonly settings: Settings,
    private readonly stage: Stage,
    private readonly forest: Forest,
    private readonly client: ForestClient,
    private readonly meter: FrameStatistics,
    retry: () => void,
  ) {
    this.again.type = "button";
    this.again.addEventListener("click", retry);
    element("status").replaceChildren(this.words, this.again);
  }

  /** `events`: whether the event stream is open. */
  show(events: boolean, listed: ListedTrees): void {
    const { forest } = this;
    const { connection, lookup_ms } = this.client;
    this.meter.publish({
      lookup_ms,
      trees: forest.trees.moving,
      triangles: forest.triangles,
      drawCalls: this.stage.renderer.info.render.calls,
      ...streamFigures(connection),
    });
    const { state, text } = statusLine({ events, lookup: this.settings.lookup, connection });
    const { dataset } = element("status");
    dataset.state = state;
    dataset.lookup = this.settings.lookup;
    write(this.words, text);
    this.again.hidden = state !== "lost";
    write(element("summary"), summary(forest.trees, listed));
  }
}

function streamFigures({ state, kB_s, latency_ms, frameAge_ms }: Connection) {
  const live = state === "live";
  const ms = (time_ms: number | null) => (live && time_ms !== null ? `${time_ms.toFixed(0)} ms` : "–");
  return {
    stream: live ? `${kB_s.toFixed(0)} kB/s` : "off",
    latency: ms(latency_ms),
    frameAge: ms(frameAge_ms),
  };
}
