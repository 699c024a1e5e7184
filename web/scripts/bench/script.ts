/** CPU time of the main thread's script per frame; wall time would include the software rasteriser. */
import type { Browser, Page } from "@playwright/test";

interface Event {
  readonly name: string;
  /** CPU time of the thread, µs. */
  readonly tdur?: number;
}

/** CPU times of the callbacks of the next frames, ms. */
export async function scriptTimes_ms(browser: Browser, page: Page, frames: number): Promise<number[]> {
  await browser.startTracing(page, { categories: ["devtools.timeline"] });
  const from = await page.evaluate(() => window.galewood?.frame ?? 0);
  await page.waitForFunction((until) => (window.galewood?.frame ?? 0) >= until, from + frames, {
    polling: 500, // not per frame, because its own callbacks would be counted
    timeout: 180_000,
  });
  const { traceEvents } = JSON.parse((await browser.stopTracing()).toString()) as { traceEvents: Event[] };
  return traceEvents
    .filter(({ name, tdur }) => name === "FireAnimationFrame" && tdur !== undefined)
    .map(({ tdur = 0 }) => tdur / 1000);
}
