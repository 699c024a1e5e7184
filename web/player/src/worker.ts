/** The worker of a forest: `galewood.worker.js`. */
import type { ToWorker } from "./worker/messages";
import { answer } from "./worker/serve";
import { Stepper } from "./worker/stepper";

const scope = self as unknown as Worker;
const stepper = new Stepper();

scope.onmessage = ({ data }: MessageEvent<ToWorker>) =>
  answer(stepper, data, (message, transfer) => scope.postMessage(message, transfer));
