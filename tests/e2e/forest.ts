/** Helpers of the page tests: open the page, wait for trees, compare pictures. */
import { test as base, expect, type Page } from "@playwright/test";
import { PNG } from "pngjs";

export { expect };

export const SMALL = "panel=0&quality=low&trees=6&flutter=0";

/** Tests fail if the console of the page shows errors or warnings. */
export const test = base.extend<{ quiet: string[] }>({
  quiet: [
    async ({ page }, use) => {
      const complaints: string[] = [];
      page.on("console", (message) => {
        if (message.type() === "error" || message.type() === "warning") complaints.push(message.text());
      });
      page.on("pageerror", (error) => complaints.push(error.message));
      await use(complaints);
      // Ignore Chromium's remark about reading pixels from a software canvas.
      expect(complaints.filter((text) => !/GPU stall due to ReadPixels/.test(text))).toEqual([]);
    },
    { auto: true },
  ],
});

export const open = (page: Page, query: string) => page.goto(`${process.env.BASE_URL}/?${query}`);

/** Waits until moving trees are displayed. */
export async function forest(page: Page): Promise<void> {
  await page.waitForFunction(() => (window.galewood?.trees.moving ?? 0) > 0 && window.galewood!.time_s > 0.2);
}

export const sway_m = (page: Page) => page.evaluate(() => Math.hypot(...window.galewood!.crownDisplacement_m));

/**
 * Waits until the crowns stand still in a steady wind: over 3 s of the forest's time their mean horizontal
 * displacement varies by less than 5 %. Returns it (x, z).
 */
export async function steadyDisplacement_m(page: Page): Promise<[number, number]> {
  const samples = await page.evaluateHandle(() => [] as [number, number, number][]);
  await page.waitForFunction(
    (kept) => {
      const { time_s, crownDisplacement_m } = window.galewood!;
      if (kept.at(-1)?.[0] !== time_s) kept.push([time_s, crownDisplacement_m[0], crownDisplacement_m[2]]);
      while (kept.length > 1 && kept[1][0] <= time_s - 3) kept.shift();
      if (kept[0][0] > time_s - 3) return false;
      const range = (k: 1 | 2) => Math.max(...kept.map((at) => at[k])) - Math.min(...kept.map((at) => at[k]));
      return Math.hypot(range(1), range(2)) < 0.05 * Math.hypot(crownDisplacement_m[0], crownDisplacement_m[2]);
    },
    samples,
    { timeout: 180_000 },
  );
  const [, x, z] = (await samples.jsonValue()).at(-1)!;
  return [x, z];
}

/** Waits for more frames. */
export async function frames(page: Page, count: number): Promise<void> {
  const from = await page.evaluate(() => window.galewood!.frame);
  await page.waitForFunction((until) => window.galewood!.frame >= until, from + count);
}

export interface Picture {
  width: number;
  height: number;
  data: Uint8Array;
}

export async function picture(page: Page): Promise<Picture> {
  return PNG.sync.read(await page.locator("#view").screenshot({ timeout: 90_000 }));
}

/** Number of pixels that differ in any channel by more than `tolerance` of 255. */
export function changedPixels(a: Picture, b: Picture, tolerance: number): number {
  let changed = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    if ([0, 1, 2].some((c) => Math.abs(a.data[i + c] - b.data[i + c]) > tolerance)) changed++;
  }
  return changed;
}
