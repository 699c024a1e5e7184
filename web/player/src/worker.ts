/** The worker of a forest: `galewood.worker.js`. */
import { drawnBuffers } from "../../src/worker/table/drawnMotion";
import type { FromWorker, ToWorker } from "./worker/messages";
import { Stepper } from "./worker/stepper";

const scope = self as unknown as {
  onmessage: (event: MessageEvent<ToWorker>) => void;
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
};
const stepper = new Stepper();

async function bytesFrom(from: string | ArrayBuffer): Promise<ArrayBuffer> {
  if (typeof from !== "string") return from;
  const response = await fetch(from);
  if (!response.ok) throw new Error(`${from}: the server responded with status ${response.status}`);
  return response.arrayBuffer();
}

async function load(table: number, from: string | ArrayBuffer): Promise<void> {
  try {
    const motion = stepper.read(table, await bytesFrom(from));
    scope.postMessage({ kind: "table", table, motion }, drawnBuffers(motion));
  } catch (error) {
    const fault = error instanceof Error ? error.message : String(error);
    scope.postMessage({ kind: "failed", table, fault });
  }
}

scope.onmessage = ({ data }) => {
  if (data.kind === "load") void load(data.table, data.from);
  else if (data.kind === "plant") stepper.plant(data.group, data.table, data.placement);
  else if (data.kind === "remove") stepper.remove(data.group);
  else if (data.kind === "wind") stepper.setWind(data.wind);
  else {
    const { dt_s, viewer, frames } = data;
    stepper.advance(dt_s, viewer, frames);
    const buffers = frames.flatMap(({ poses, velocity }) =>
      velocity ? [poses.buffer, velocity.buffer] : [poses.buffer],
    );
    scope.postMessage({ kind: "poses", time_s: stepper.time_s, frames }, buffers);
  }
};
