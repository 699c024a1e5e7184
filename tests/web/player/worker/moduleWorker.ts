/** The worker's module in this thread, once per worker: messages are copied and transferred as between threads. */
import { vi } from "vitest";
import type { FromWorker, ToWorker } from "../../../../web/player/src/worker/protocol";

interface Scope {
  onmessage?: (event: { data: ToWorker }) => void;
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
}

/** Modules are evaluated one after the other, because each takes the global `self` that it finds. */
let evaluated: Promise<unknown> = Promise.resolve();

export class ModuleWorker {
  onmessage: ((event: MessageEvent<FromWorker>) => void) | null = null;
  onerror: ((event: ErrorEvent) => void) | null = null;
  /** All that it was told. */
  readonly told: ToWorker[] = [];
  ended = false;
  private readonly scope: Scope;
  private readonly ready: Promise<unknown>;

  constructor() {
    this.scope = {
      postMessage: (message, transfer = []) => {
        const data = structuredClone(message, { transfer });
        setTimeout(() => this.ended || this.onmessage?.({ data } as MessageEvent<FromWorker>));
      },
    };
    this.ready = evaluated.then(async () => {
      vi.resetModules();
      vi.stubGlobal("self", this.scope);
      await import("../../../../web/player/src/worker/forestWorker");
    });
    evaluated = this.ready;
  }

  postMessage(message: ToWorker, transfer: Transferable[] = []): void {
    const data = structuredClone(message, { transfer });
    this.told.push(data);
    void this.ready.then(() => this.ended || this.scope.onmessage?.({ data }));
  }

  terminate(): void {
    this.ended = true;
  }

  /** An error that nobody catches. */
  crash(message: string): void {
    this.onerror?.({ message } as ErrorEvent);
  }
}
