/** Starts the real server on a free port with a data folder of its own, unless BASE_URL names one,
 * and waits until its three species are computed. */
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { freePort, serve, STARTS_WITHIN_MS, stop, until } from "./server";

/** On whatever this machine has. */
const TABLES_WITHIN_MS = 20 * 60_000;

interface Listed {
  trees: { state: string; builtin: boolean; name: string }[];
}

/** Whether every species of our own has its table. */
async function allReady(base: string): Promise<boolean> {
  const { trees } = (await (await fetch(`${base}/api/trees`)).json()) as Listed;
  const own = trees.filter((tree) => tree.builtin);
  return own.length > 0 && own.every((tree) => tree.state === "ready");
}

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
  const base = process.env.BASE_URL;
  try {
    await until("the server", STARTS_WITHIN_MS, async () => (await fetch(`${base}/healthz`)).ok);
    // All of them: one that joined in the middle of a test would change its pictures.
    await until("the three species", TABLES_WITHIN_MS, () => allReady(base));
  } catch (error) {
    await end();
    throw error;
  }
  return end;
}
