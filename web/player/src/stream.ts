/** Forests whose motion a Galewood service computes and streams: private ones, or shared by everyone who names them. */
import type { WindDocument } from "./core/wind/document";
import { startAt } from "./three/start";
import type { StreamNews, StreamRequest } from "./worker/simple/streamed";

export interface StreamOptions {
  /** Address of the service. */
  readonly service: string | URL;
  /** Id of a shared forest: all who name it see the same trees in the same wind. Without it the forest is private. */
  readonly share?: string;
  /** Whether the trees of a shared forest are replaced by these for everyone, if they differ. Default: false. */
  readonly replant?: boolean;
  /** Called with the number of clients of a shared forest. */
  readonly onPresent?: (clients: number) => void;
  /** Called when someone changes the wind of a shared forest. */
  readonly onWind?: (wind: WindDocument) => void;
  /** Called with what went wrong; without it, problems are warnings of the console. */
  readonly onProblem?: (title: string, hint: string) => void;
}

function socketOf(service: string | URL): string {
  const base = `${new URL(service, document.baseURI)}`.replace(/\/?$/, "/");
  return new URL("ws/forest", base.replace(/^http/, "ws")).href;
}

/** The worker of a streamed forest: `new Forest({ wind, worker: streamed({ service, share: "park" }) })`. */
export function streamed(options: StreamOptions): () => Worker {
  const { service, share = null, replant = false, onPresent, onWind } = options;
  const { onProblem = (title: string, hint: string) => console.warn(title, hint) } = options;
  return () => {
    const worker = startAt(
      () => new Worker(new URL("./galewood.stream.worker.js", import.meta.url), { type: "module" }),
      () => new URL("./galewood.stream.worker.js", import.meta.url),
    );
    worker.addEventListener("message", ({ data }: MessageEvent<StreamNews>) => {
      if (data.kind === "present") onPresent?.(data.clients);
      else if (data.kind === "sharedWind") onWind?.(data.wind);
      else if (data.kind === "problem") onProblem(data.title, data.hint);
    });
    const request: StreamRequest = { kind: "stream", url: socketOf(service), share, replant };
    worker.postMessage(request);
    return worker;
  };
}
