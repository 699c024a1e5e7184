/** Reads the meshes of trees beside the page, which draws meanwhile. */
import { answer, buffersIn, type ReadOrder } from "./reading";

self.onmessage = ({ data }: MessageEvent<ReadOrder>) => {
  const reply = answer(data);
  self.postMessage(reply, { transfer: [...buffersIn(reply)] });
};
