/** A page that draws only on request, for pictures of any size. */
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import type { Page } from "@playwright/test";
import type { Shot } from "./shots";

const BASE_URL = process.env.BASE_URL ?? "http://127.0.0.1:8000";
export const PICTURES_FOLDER = process.env.FOLDER ?? resolve(import.meta.dirname, "../../../docs/images");
export const LARGE_VIEWPORT = { width: 1200, height: 675 };
/** Viewport while time advances and nothing is shown. */
export const TINY_VIEWPORT = { width: 96, height: 54 };
export const PATIENCE_MS = 900_000;
const STEP_S = 0.05;
const MOST_BAKING_FRAMES = 900;
/** Nothing but sky. */
const SKY_VIEW = { eye: { x: 0, above: 400, z: 0 }, at: { x: 200, above: 500, z: 0 } } as const;
const QUALITIES = [84, 78, 70, 60];
const MOST_BYTES = 300_000;

export const LOOK_QUERY = `quality=${process.env.QUALITY ?? "medium"}&trees=${process.env.TREES ?? 320}&density=1.2`;

/**
 * Opens a forest, waits until every tree moves, and stops its frame loop. `baked`: waits for the pictures of distant trees, too; `dress` makes
 * them faster.
 */
export async function forest(page: Page, query: string, baked = true): Promise<void> {
  await page.goto(`${BASE_URL}/?${query}`, { waitUntil: "commit" });
  await page.waitForFunction(() => (window.galewood?.trees.moving ?? 0) > 0);
  await page.waitForFunction(
    () => window.galewood?.allPlanted && window.galewood.trees.still === 0 && window.galewood.time_s > 0,
  );
  if (baked) await page.waitForFunction(() => window.galewood?.statistics.impostors.ready);
  await page.evaluate(() => window.galewood?.sleep(true));
}

/** Waits until distant trees have their pictures, a few of which are made per frame. Meanwhile only sky is seen, which is drawn fast. */
async function bakeImpostors(page: Page): Promise<void> {
  await page.evaluate(
    async ({ mostFrames, sky }) => {
      window.galewood?.look(sky.eye, sky.at);
      for (let k = 0; k < mostFrames; k++) {
        await window.galewood?.step(0);
        if (window.galewood?.statistics.impostors.ready) return;
      }
    },
    { mostFrames: MOST_BAKING_FRAMES, sky: SKY_VIEW },
  );
}

/** Advances by `count` time steps without drawing. */
export async function steps(page: Page, count: number, dt_s = STEP_S): Promise<void> {
  await page.evaluate(
    async ({ count, dt_s }) => {
      for (let k = 0; k < count; k++) await window.galewood?.step(dt_s, false);
    },
    { count, dt_s },
  );
}

export async function dress(page: Page, { season, daytime, eye, at, wind }: Shot): Promise<void> {
  // Where winter begins or ends, distant trees are drawn once more.
  await page.evaluate(
    ({ season, daytime, wind }) => {
      if (wind) window.galewood?.setWind(wind);
      window.galewood?.dress(season, daytime);
    },
    { season, daytime, wind },
  );
  await bakeImpostors(page);
  await page.evaluate(({ eye, at }) => window.galewood?.look(eye, at), { eye, at });
}

/** Resizes the viewport and waits for the layout. */
export async function resize(page: Page, size: { width: number; height: number }): Promise<void> {
  await page.setViewportSize(size);
  await page.waitForFunction(({ width }) => {
    const canvas = document.querySelector<HTMLCanvasElement>("#view")?.width ?? 0;
    return innerWidth === width && canvas >= width / 2 && canvas <= 2 * width;
  }, size);
}

/** Draws one frame and reads it from the canvas: the forest without the page around it. */
export async function frame(page: Page, dt_s: number, type: string, quality = 1): Promise<Buffer> {
  const url = await page.evaluate(
    async ({ dt_s, type, quality }) => {
      await window.galewood?.step(dt_s);
      return document.querySelector<HTMLCanvasElement>("#view")?.toDataURL(type, quality) ?? "";
    },
    { dt_s, type, quality },
  );
  return Buffer.from(url.slice(url.indexOf(",") + 1), "base64");
}

/** Runs the frame loop for some frames, so that the window shows the current state. */
export async function drawn(page: Page, frames = 2): Promise<void> {
  const from = await page.evaluate(() => {
    window.galewood?.sleep(false);
    return window.galewood?.frame ?? 0;
  });
  await page.waitForFunction((until) => (window.galewood?.frame ?? 0) >= until, from + frames);
  await page.evaluate(() => window.galewood?.sleep(true));
}

/** Saves a screenshot at the best quality that fits the size limit. */
export async function save(page: Page, name: string): Promise<void> {
  const path = `${PICTURES_FOLDER}/${name}.jpg`;
  for (const quality of QUALITIES) {
    const bytes = await page.screenshot({ path, type: "jpeg", quality, timeout: PATIENCE_MS });
    if (bytes.length <= MOST_BYTES) break;
  }
  console.log(`${name}.jpg`);
}

/** Saves a picture. The viewport is small while time advances, to save time, and large for the picture. */
export async function take(page: Page, name: string, shot: Shot): Promise<void> {
  await resize(page, TINY_VIEWPORT);
  await dress(page, shot);
  await steps(page, Math.round(shot.after_s / STEP_S));
  await resize(page, LARGE_VIEWPORT);
  for (const quality of QUALITIES) {
    const bytes = await frame(page, 0, "image/jpeg", quality / 100);
    writeFileSync(`${PICTURES_FOLDER}/${name}.jpg`, bytes);
    if (bytes.length <= MOST_BYTES) break;
  }
  console.log(`${name}.jpg`);
}
