/** The worker of a forest: `galewood.worker.js`. */
import type { ToWorker } from "./worker/simple/messages";
import { answer } from "./worker/simple/serve";
import { Stepper } from "./worker/simple/stepper";

const scope = self as unknown as Worker;
const stepper = new Stepper();

scope.onmessage = ({ data }: MessageEvent<ToWorker>) =>
  answer(stepper, data, (message, transfer) => scope.postMessage(message, transfer));
