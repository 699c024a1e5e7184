/**
 * Takes the pictures of docs/images from a running server: `BASE_URL=http://127.0.0.1:8000 npm run pictures [name …]`.
 * Needs some minutes where no graphics card draws.
 */
import { existsSync } from "node:fs";
import { resolve } from "node:path";
import { chromium, type Page } from "@playwright/test";

const BASE = process.env.BASE_URL ?? "http://127.0.0.1:8000";
const FOLDER = resolve(import.meta.dirname, "../../docs/images");
const CHROMIUM = "/usr/bin/chromium";
const LARGE = { width: 1200, height: 675 };
const TINY = { width: 96, height: 54 };
const PATIENCE_MS = 600_000;
const JPEG_QUALITY = 80;

type Place = { x: number; above: number; z: number };

interface Shot {
  readonly season: "spring" | "summer" | "autumn" | "winter";
  readonly daytime: number;
  readonly eye: Place;
  readonly at: Place;
  readonly wind?: object;
  /** Seconds of wind before the picture. */
  readonly after_s?: number;
}

const STORM = {
  version: 1,
  direction_deg: 20,
  seed: 1,
  model: "navier-stokes",
  mean_speed_m_s: 21,
  gustiness: 0.9,
  convection_speed_m_s: 20,
  length_scale_m: 40,
};
const EDGE = { eye: { x: 7, above: 8.2, z: 24 }, at: { x: -1, above: 6.2, z: -16 } };

const SHOTS: Record<string, Shot> = {
  "autumn-noon": { season: "autumn", daytime: 0.6, ...EDGE, after_s: 1 },
  "autumn-sunset": {
    season: "autumn",
    daytime: 0.955,
    eye: { x: 33, above: 15, z: -18 },
    at: { x: -16, above: 5, z: -20 },
  },
  winter: { season: "winter", daytime: 0.3, ...EDGE },
  summer: {
    season: "summer",
    daytime: 0.42,
    eye: { x: 2, above: 1.9, z: -2 },
    at: { x: -9, above: 6.5, z: -24 },
  },
  storm: {
    season: "autumn",
    daytime: 0.72,
    eye: { x: 5, above: 3.6, z: 10 },
    at: { x: -1, above: 6, z: -14 },
    wind: STORM,
    after_s: 8,
  },
};

async function frames(page: Page, count: number): Promise<void> {
  const from = await page.evaluate(() => window.galewood?.frame ?? 0);
  await page.waitForFunction((until) => (window.galewood?.frame ?? 0) >= until, from + count);
}

async function forest(page: Page, query: string): Promise<void> {
  await page.goto(`${BASE}/?${query}`, { waitUntil: "commit" });
  await page.waitForFunction(() => (window.galewood?.trees.moving ?? 0) > 0);
  await page.waitForFunction(() => window.galewood?.trees.still === 0);
}

async function save(page: Page, name: string): Promise<void> {
  await frames(page, 2);
  await page.evaluate(() => window.galewood?.sleep(true));
  await page.screenshot({
    path: `${FOLDER}/${name}.jpg`,
    type: "jpeg",
    quality: JPEG_QUALITY,
    timeout: PATIENCE_MS,
  });
  await page.evaluate(() => window.galewood?.sleep(false));
  console.log(`${name}.jpg`);
}

/** Small while the wind blows, so that it costs little; large for the picture. */
async function take(page: Page, name: string, shot: Shot): Promise<void> {
  await page.setViewportSize(TINY);
  await page.evaluate(({ season, daytime, eye, at, wind }) => {
    if (wind) window.galewood?.setWind(wind);
    window.galewood?.dress(season, daytime);
    window.galewood?.look(eye, at);
  }, shot);
  const until_s = (await page.evaluate(() => window.galewood?.time_s ?? 0)) + (shot.after_s ?? 0);
  await page.waitForFunction((time_s) => (window.galewood?.time_s ?? 0) >= time_s, until_s);
  await page.setViewportSize(LARGE);
  await save(page, name);
}

const wanted = process.argv.slice(3);
const wants = (name: string) => wanted.length === 0 || wanted.includes(name);
const SOFTWARE = ["--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist"];
const browser = await chromium.launch({
  ...(existsSync(CHROMIUM) && { executablePath: CHROMIUM }),
  args: [...(process.env.GPU ? [] : SOFTWARE), "--no-sandbox", "--disable-quic", "--no-first-run"],
});
const page = await browser.newPage({ viewport: TINY });
page.setDefaultTimeout(PATIENCE_MS);
const look = `quality=${process.env.QUALITY ?? "medium"}&trees=${process.env.TREES ?? 240}`;
await forest(page, `${look}&speed=7&panel=0`);
for (const [name, shot] of Object.entries(SHOTS)) if (wants(name)) await take(page, name, shot);
if (wants("page")) {
  await forest(page, `${look}&speed=7&time=0.7`);
  await page.setViewportSize(LARGE);
  await save(page, "page");
}
if (wants("phone")) {
  await page.setViewportSize({ width: 390, height: 780 });
  await forest(page, "quality=low&trees=60&speed=7&time=0.7");
  await save(page, "phone");
}
await browser.close();
