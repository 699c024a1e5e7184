/** Starts the real server on a free port with a data folder of its own, unless BASE_URL names one,
 * and waits until its three species are computed. */
import { type ChildProcess, spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

const REPOSITORY = resolve(__dirname, "../..");
const STARTS_WITHIN_MS = 90_000;
/** On whatever this machine has. */
const TABLES_WITHIN_MS = 20 * 60_000;

const pause = (ms: number) => new Promise((done) => setTimeout(done, ms));

function freePort(): Promise<number> {
  return new Promise((found, failed) => {
    const probe = createServer();
    probe.once("error", failed);
    probe.listen(0, "127.0.0.1", () => {
      const address = probe.address();
      probe.close(() => (address && typeof address === "object" ? found(address.port) : failed(address)));
    });
  });
}

async function until(what: string, within_ms: number, holds: () => Promise<boolean>): Promise<void> {
  const end = Date.now() + within_ms;
  while (Date.now() < end) {
    if (await holds().catch(() => false)) return;
    await pause(500);
  }
  throw new Error(`waited ${within_ms / 1000} s for ${what}`);
}

function serve(port: number, data: string): ChildProcess {
  const own = join(REPOSITORY, ".venv/bin/galewood");
  const env = { ...process.env, PORT: String(port), HOST: "127.0.0.1", GALEWOOD_DATA_DIR: data };
  const server = spawn(existsSync(own) ? own : "galewood", ["serve"], {
    cwd: REPOSITORY,
    env,
    stdio: ["ignore", "ignore", process.env.E2E_LOG ? "inherit" : "ignore"],
    detached: true,
  });
  server.on("error", (error) => console.error(`the server did not start: ${error.message}`));
  return server;
}

async function stop(server: ChildProcess): Promise<void> {
  if (server.exitCode !== null || server.pid === undefined) return;
  const ended = new Promise((done) => server.once("exit", done));
  server.kill("SIGTERM");
  await Promise.race([ended, pause(15_000)]);
  try {
    process.kill(-server.pid, "SIGKILL"); // whatever the group still holds
  } catch {
    // nothing was left
  }
}

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
