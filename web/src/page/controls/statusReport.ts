/** Writes the figures of the panel, the status line and the summary of the forest. */

import type { Connection } from "galewood/client";
import type { FrameStatistics } from "../forest/frameStatistics";
import type { World } from "../forest/world";
import type { Catalogue } from "../server/catalogue";
import type { Store } from "../store/store";
import { element, make, makeButton, write } from "../ui/dom";
import { statusLine, summary } from "../ui/words";

export class StatusReport {
  private readonly words = make("span");
  private readonly again: HTMLButtonElement;

  /** `retry` tries lost connections at once. */
  constructor(
    private readonly store: Store,
    private readonly world: World,
    private readonly catalogue: Catalogue,
    private readonly meter: FrameStatistics,
    retry: () => void,
  ) {
    this.again = makeButton("Try now", retry, "try-now");
    element("status").replaceChildren(this.words, this.again);
  }

  report(): void {
    const { forest, client, stage } = this.world;
    const { connection, lookup_ms } = client;
    this.meter.publish({
      lookup_ms,
      trees: forest.trees.moving,
      triangles: forest.triangles,
      drawCalls: stage.renderer.info.render.calls,
      ...streamFigures(connection),
    });
    const { lookup } = this.store.settings;
    const { state, text } = statusLine({ events: this.store.state.connected, lookup, connection });
    const { dataset } = element("status");
    dataset.state = state;
    dataset.lookup = lookup;
    write(this.words, text);
    this.again.hidden = state !== "lost";
    write(element("summary"), summary(forest.trees, this.catalogue.listed));
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
