import { expect, test } from "vitest";
import { WorkerClient } from "../../../../web/player/src/three/worker";

/** A worker that never answers. */
const silent = () => ({ postMessage: () => {}, terminate: () => {} }) as unknown as Worker;

test("loading ends with an AbortError when the forest is disposed of, also when it begins later", async () => {
  const client = new WorkerClient(silent());
  const loading = client.load("poplar.table");
  client.dispose();
  await expect(loading).rejects.toMatchObject({ name: "AbortError" });
  await expect(client.load("maple.table")).rejects.toMatchObject({ name: "AbortError" });
});

test("loading fails with the reason when the worker cannot run", async () => {
  const worker = silent();
  const client = new WorkerClient(worker);
  const loading = client.load("poplar.table");
  worker.onerror?.({ message: "no such file" } as ErrorEvent);
  await expect(loading).rejects.toThrow("The forest worker is not running: no such file");
});
