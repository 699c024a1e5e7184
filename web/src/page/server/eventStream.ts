/** The server-sent events: the state of every tree, then every change. */

import { Backoff } from "galewood/client";
import type { TreeChange } from "./api";

export interface EventHandlers {
  change(change: TreeChange): void;
  open(): void;
  lost(): void;
}

export interface EventStream {
  /** Connects at once if the connection is lost. */
  retry(): void;
  close(): void;
}

/** Follows the events and reconnects automatically. */
export function followEvents(handlers: EventHandlers): EventStream {
  const backoff = new Backoff();
  let source: EventSource | null = null;
  let timer: ReturnType<typeof setTimeout> | null = null;
  const connect = () => {
    timer = null;
    source = new EventSource("api/events");
    source.onmessage = (event: MessageEvent<string>) => handlers.change(JSON.parse(event.data) as TreeChange);
    source.onopen = () => {
      backoff.reset();
      handlers.open();
    };
    source.onerror = () => {
      // Browsers wait seconds before reconnecting and give up after some responses, so reconnect here.
      source?.close();
      handlers.lost();
      timer = setTimeout(connect, backoff.next_ms());
    };
  };
  const stopWaiting = () => {
    if (timer !== null) clearTimeout(timer);
  };
  connect();
  return {
    retry() {
      if (timer === null) return;
      stopWaiting();
      backoff.reset();
      connect();
    },
    close() {
      stopWaiting();
      source?.close();
    },
  };
}
