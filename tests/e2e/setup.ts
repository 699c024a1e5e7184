/** Starts the real server on a free port with a data folder of its own, unless BASE_URL names one,
 * and waits until its three species are computed. */
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { freePort, serve, stop, untilReady } from "./server";

export default async function setup(): Promise<() => Promise<void>> {
  let end = async () => {};
  if (!process.env.BASE_URL) {
    const port = await freePort();
    const kept = process.env.E2E_DATA_DIR;
    const data = kept ?? mkdtempSync(join(tmpdir(), "galewood-e2e-"));
    const server = serve(port, data);
    process.env.SERVER_DATA = data;
    process.env.BASE_URL = `http://127.0.0.1:${port}`;
    end = async () => {
      await stop(server);
      if (!kept) rmSync(data, { recursive: true, force: true });
    };
  }
  try {
    await untilReady(process.env.BASE_URL);
  } catch (error) {
    await end();
    throw error;
  }
  return end;
}
