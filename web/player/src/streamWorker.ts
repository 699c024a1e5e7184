/** The worker of a forest that a service moves: `galewood.stream.worker.js`. */
import type { ToWorker } from "./worker/simple/messages";
import { answer } from "./worker/simple/serve";
import { StreamedForest, type StreamRequest } from "./worker/simple/streamed";

const scope = self as unknown as Worker;
let forest: StreamedForest | null = null;

scope.onmessage = ({ data }: MessageEvent<ToWorker | StreamRequest>) => {
  if (data.kind === "stream") forest = new StreamedForest(data, (news) => scope.postMessage(news));
  else if (forest) answer(forest, data, (message, transfer) => scope.postMessage(message, transfer));
};
