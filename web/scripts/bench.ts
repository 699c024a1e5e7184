/**
 * Benchmark of the page in headless Chromium with software rendering; see README, "Benchmark".
 *
 *   npm run bench -- [--base URL | --data DIR] [--minutes 0.5] [--json build/bench-web.json]
 *   npm run bench -- --only worker        # one part: start, worker, 1000, 10000, rivals, memory
 *   npm run bench -- --soak-minutes 10    # only the heap, for this time
 *
 * Paths are relative to the repository. Without --base a server is started on the data folder.
 */
import { mkdirSync, writeFileSync } from "node:fs";
import { cpus, loadavg } from "node:os";
import { dirname, resolve } from "node:path";
import { parseArgs } from "node:util";
import { chromium } from "@playwright/test";
import { LAUNCH } from "../../tests/e2e/chromium";
import { freePort, serve, stop, untilReady } from "../../tests/e2e/server";
import { measureFrames } from "./bench/frames";
import { measureMemory } from "./bench/memory";
import { type Figure, printTable } from "./bench/report";
import { measureRivals } from "./bench/rivals";
import { measureStart } from "./bench/start";
import { measureWorker } from "./bench/worker";

const { values } = parseArgs({
  args: process.argv.slice(3), // after node, the runner and this file
  options: {
    base: { type: "string" },
    data: { type: "string", default: process.env.GALEWOOD_DATA_DIR ?? "data" },
    minutes: { type: "string", default: "0.5" },
    only: { type: "string" },
    "soak-minutes": { type: "string" },
    json: { type: "string", default: "build/bench-web.json" },
  },
});

const inRepository = (path: string) => resolve(process.cwd(), "..", path);
const say = (text: string) => console.error(text);

async function measure(base: string): Promise<Figure[]> {
  say("Waiting for the species");
  await untilReady(base);
  const browser = await chromium.launch(LAUNCH);
  try {
    const figures: Figure[] = [];
    const soak = values["soak-minutes"];
    if (soak) return await measureMemory(browser, base, Number(soak));
    const steps = [
      ["start", "start", () => measureStart(browser, base)],
      ["worker", "worker", () => measureWorker(browser, base)],
      ["1000", "frames of 1,000 trees", () => measureFrames(browser, base, 1000, 1.25)],
      ["10000", "frames of 10,000 trees", () => measureFrames(browser, base, 10_000, 1.35)],
      ["rivals", "the same trees by three.js alone", () => measureRivals(browser, 10_000)],
      ["memory", "memory", () => measureMemory(browser, base, Number(values.minutes))],
    ] as const;
    for (const [part, name, step] of steps) {
      if (values.only && values.only !== part) continue;
      say(`Measuring ${name}`);
      figures.push(...(await step()));
    }
    return figures;
  } finally {
    await browser.close();
  }
}

const port = await freePort();
const server = values.base ? null : serve(port, inRepository(values.data));
try {
  const figures = await measure(values.base ?? `http://127.0.0.1:${port}`);
  printTable(figures);
  const machine = { cpu: cpus()[0]?.model, cores: cpus().length, load: loadavg()[0] };
  const file = inRepository(values.json);
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, `${JSON.stringify({ machine, figures }, null, 2)}\n`);
} finally {
  if (server) await stop(server);
}
