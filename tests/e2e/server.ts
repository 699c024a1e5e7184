/** Starts and stops a real server for the tests. */
import { type ChildProcess, spawn } from "node:child_process";
import { cpSync, existsSync, mkdtempSync, readdirSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

/** The folder of the repository. The benchmark, which also uses this module, runs in web/. */
export const REPOSITORY = typeof __dirname === "undefined" ? resolve(process.cwd(), "..") : resolve(__dirname, "../..");
export const STARTS_WITHIN_MS = 90_000;
/** Generous, for a server whose tables are not the shipped ones and have to be computed. */
const TABLES_WITHIN_MS = 20 * 60_000;

const pause = (ms: number) => new Promise((done) => setTimeout(done, ms));

export function freePort(): Promise<number> {
  return new Promise((found, failed) => {
    const probe = createServer();
    probe.once("error", failed);
    probe.listen(0, "127.0.0.1", () => {
      const address = probe.address();
      probe.close(() => (address && typeof address === "object" ? found(address.port) : failed(address)));
    });
  });
}

export async function until(what: string, within_ms: number, holds: () => Promise<boolean>): Promise<void> {
  const end = Date.now() + within_ms;
  while (Date.now() < end) {
    if (await holds().catch(() => false)) return;
    await pause(500);
  }
  throw new Error(`waited ${within_ms / 1000} s for ${what}`);
}

/** Starts a server; `settings` are further environment variables. */
export function serve(port: number, data: string, settings: Record<string, string> = {}): ChildProcess {
  const own = join(REPOSITORY, ".venv/bin/galewood");
  const env = { ...process.env, PORT: String(port), HOST: "127.0.0.1", GALEWOOD_DATA_DIR: data, ...settings };
  const server = spawn(existsSync(own) ? own : "galewood", ["serve"], {
    cwd: REPOSITORY,
    env,
    stdio: ["ignore", "ignore", process.env.E2E_LOG ? "inherit" : "ignore"],
    detached: true,
  });
  server.on("error", (error) => console.error(`the server did not start: ${error.message}`));
  return server;
}

/** Copies the data that a second server needs, without the cache of computations. */
export function copyOf(data: string): string {
  const copy = mkdtempSync(join(tmpdir(), "galewood-again-"));
  for (const name of readdirSync(data)) {
    if (name !== "cache" && !name.startsWith(".lock")) cpSync(join(data, name), join(copy, name), { recursive: true });
  }
  return copy;
}

export async function stop(server: ChildProcess): Promise<void> {
  if (server.exitCode !== null || server.pid === undefined) return;
  const ended = new Promise((done) => server.once("exit", done));
  server.kill("SIGTERM");
  await Promise.race([ended, pause(15_000)]);
  try {
    process.kill(-server.pid, "SIGKILL"); // remaining processes of the group
  } catch {
    // all processes have ended
  }
}

interface Listed {
  trees: { state: string; builtin: boolean; name: string; records_sha256?: string | null }[];
}

/** Whether every built-in species has its table and the records of the paper's method. */
async function allReady(base: string): Promise<boolean> {
  const { trees } = (await (await fetch(`${base}/api/trees`)).json()) as Listed;
  const own = trees.filter((tree) => tree.builtin);
  return own.length > 0 && own.every((tree) => tree.state === "ready" && tree.records_sha256 !== null);
}

/** Waits until a server responds and its species are ready. */
export async function untilReady(base: string): Promise<void> {
  await until("the server", STARTS_WITHIN_MS, async () => (await fetch(`${base}/healthz`)).ok);
  // All of them, because a species that is added during a test would change its pictures.
  await until("the species", TABLES_WITHIN_MS, () => allReady(base));
}
