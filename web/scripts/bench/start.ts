/** Time from navigation to the first moving tree on a warm server, and its script time. */
import { gzipSync } from "node:zlib";
import type { Browser } from "@playwright/test";
import { openPage } from "./page";
import { type Figure, median } from "./report";

const VISIT_COUNT = 3;

async function visit(browser: Browser, base: string) {
  const scripts = new Set<string>();
  const context = await browser.newContext();
  context.on("request", (request) => {
    if (/\.js(\?|$)/.test(request.url())) scripts.add(request.url());
  });
  const page = await openPage(browser, base, "trees=60");
  page.on("request", (request) => {
    if (/\.js(\?|$)/.test(request.url())) scripts.add(request.url());
  });
  await page.waitForFunction(() => window.counted.firstMoving_ms !== null, undefined, { timeout: 180_000 });
  const times = await page.evaluate(() => {
    const loaded = performance.getEntriesByType("resource").map(({ name }) => name);
    const paint = performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Number.NaN;
    return { paint_ms: paint, moving_ms: window.counted.firstMoving_ms ?? Number.NaN, loaded };
  });
  await page.close();
  await context.close();
  for (const name of times.loaded) if (/\.js(\?|$)/.test(name)) scripts.add(name);
  return { ...times, scripts };
}

async function compressedBytes(url: string): Promise<number> {
  const text = await (await fetch(url)).arrayBuffer();
  return gzipSync(new Uint8Array(text), { level: 9 }).length;
}

/** The first visit (cold server and browser) is reported separately from the three measured ones. */
export async function measureStart(browser: Browser, base: string): Promise<Figure[]> {
  const cold = await visit(browser, base);
  const visits = [];
  for (let k = 0; k < VISIT_COUNT; k++) visits.push(await visit(browser, base));
  const sizes = await Promise.all([...cold.scripts].map(compressedBytes));
  const paint = visits.map(({ paint_ms }) => paint_ms / 1000);
  const moving = visits.map(({ moving_ms }) => moving_ms / 1000);
  return [
    { name: "first paint", value: median(paint), unit: "s", all: paint },
    { name: "first moving tree", value: median(moving), unit: "s", all: moving },
    { name: "first paint, just started", value: cold.paint_ms / 1000, unit: "s" },
    { name: "first moving tree, just started", value: cold.moving_ms / 1000, unit: "s" },
    {
      name: "script before the forest shows, gzip",
      value: sizes.reduce((a, b) => a + b, 0) / 1000,
      unit: "kB",
      most: 400,
    },
  ];
}
