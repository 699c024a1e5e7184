/** Helpers of the page tests: open the page, wait for trees, compare pictures. */
import { test as base, expect, type Page } from "@playwright/test";
import { PNG } from "pngjs";

export { expect };

export const SMALL = "panel=0&quality=low&trees=6&flutter=0&background=0";

/**
 * Runs in every page before its scripts: few frames a second, because this processor draws them, and other tests need it
 * too. What a page does in a frame is the same.
 */
function drawSlowly(): void {
  const every_ms = 180;
  const soon = window.requestAnimationFrame.bind(window);
  const timers = new Map<number, number>();
  let last = 0;
  window.requestAnimationFrame = (callback) => {
    const id = ++last;
    const run = (now_ms: number) => timers.delete(id) && callback(now_ms);
    timers.set(id, window.setTimeout(() => soon(run), every_ms - (performance.now() % every_ms)));
    return id;
  };
  window.cancelAnimationFrame = (id) => {
    window.clearTimeout(timers.get(id));
    timers.delete(id);
  };
}

/** Tests fail if the console of the page shows errors or warnings. */
export const test = base.extend<{ quiet: string[] }>({
  quiet: [
    async ({ context, page }, use) => {
      await context.addInitScript(drawSlowly);
      const complaints: string[] = [];
      page.on("console", (message) => {
        if (message.type() === "error" || message.type() === "warning") complaints.push(message.text());
      });
      page.on("pageerror", (error) => complaints.push(error.message));
      await use(complaints);
      // Ignore Chromium's remark about reading pixels from a software canvas, and three's one to react-three-fiber.
      const known = /GPU stall due to ReadPixels|THREE\.Clock: This module has been deprecated/;
      expect(complaints.filter((text) => !known.test(text))).toEqual([]);
    },
    { auto: true },
  ],
});

export const open = (page: Page, query: string) => page.goto(`${process.env.BASE_URL}/?${query}`);

/** Waits until moving trees are displayed. */
export async function forest(page: Page): Promise<void> {
  await page.waitForFunction(() => (window.galewood?.trees.moving ?? 0) > 0 && window.galewood!.time_s > 0.2);
}

/** Waits until the distant trees are baked and in place. */
export async function background(page: Page): Promise<void> {
  await page.waitForFunction(() => window.galewood?.statistics.impostors.ready, undefined, { timeout: 150_000 });
}

export const sway_m = (page: Page) => page.evaluate(() => Math.hypot(...window.galewood!.crownDisplacement_m));

/**
 * Waits until the mean horizontal displacement of the crowns in a steady wind no longer changes: over two spans of
 * 2 s of the forest's time, about a period of the slowest tree each, it differs by less than 3 %. Returns it (x, z).
 */
export async function steadyDisplacement_m(page: Page): Promise<[number, number]> {
  const samples = await page.evaluateHandle(() => [] as [number, number, number][]);
  const found = await page.waitForFunction(
    (kept) => {
      const span_s = 2;
      const { time_s, crownDisplacement_m } = window.galewood!;
      if (kept.at(-1)?.[0] !== time_s) kept.push([time_s, crownDisplacement_m[0], crownDisplacement_m[2]]);
      while (kept.length > 1 && kept[1][0] <= time_s - 2 * span_s) kept.shift();
      if (kept[0][0] > time_s - 2 * span_s) return null;
      const mean = (part: [number, number, number][], k: 1 | 2) =>
        part.reduce((sum, at) => sum + at[k], 0) / part.length;
      const halves = [true, false].map((late) => kept.filter((at) => at[0] > time_s - span_s === late));
      const [late, early] = halves.map((part) => [mean(part, 1), mean(part, 2)] as [number, number]);
      const change = Math.hypot(late[0] - early[0], late[1] - early[1]);
      return change < 0.03 * Math.hypot(...late) ? late : null;
    },
    samples,
    { timeout: 180_000 },
  );
  return (await found.jsonValue())!;
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
