/** What every test of the page needs: open it, wait for trees, compare pictures. */
import { test as base, expect, type Page } from "@playwright/test";
import { PNG } from "pngjs";

export { expect };

export const SMALL = "panel=0&quality=low&trees=6&flutter=0";

/** A page whose console must stay free of errors and warnings. */
export const test = base.extend<{ quiet: string[] }>({
  quiet: [
    async ({ page }, use) => {
      const complaints: string[] = [];
      page.on("console", (message) => {
        if (message.type() === "error" || message.type() === "warning") complaints.push(message.text());
      });
      page.on("pageerror", (error) => complaints.push(error.message));
      await use(complaints);
      // Chromium's own remarks on reading pixels back from a software canvas are not the page's.
      expect(complaints.filter((text) => !/GPU stall due to ReadPixels/.test(text))).toEqual([]);
    },
    { auto: true },
  ],
});

export const open = (page: Page, query: string) => page.goto(`${process.env.BASE_URL}/?${query}`);

/** Waits until trees move on screen. */
export async function forest(page: Page): Promise<void> {
  await page.waitForFunction(() => (window.galewood?.trees.moving ?? 0) > 0 && window.galewood!.time_s > 0.2);
}

export const sway_m = (page: Page) => page.evaluate(() => Math.hypot(...window.galewood!.crownDisplacement_m));

/** Lets the page draw more frames. */
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
