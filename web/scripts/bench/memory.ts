/** Whether the page's memory grows while it runs. */
import type { Browser } from "@playwright/test";
import { openPage, untilMoving } from "./page";
import type { Figure } from "./report";

const SAMPLE_COUNT = 6;

export async function measureMemory(browser: Browser, base: string, minutes: number): Promise<Figure[]> {
  const page = await openPage(browser, base, "trees=400");
  await untilMoving(page);
  const session = await page.context().newCDPSession(page);
  const heap_MB = async () => {
    // Discard the measurements, which are not part of the page.
    await page.evaluate(() => {
      const { script_ms, frame_ms, bytes } = window.counted;
      for (const list of [script_ms, frame_ms, bytes]) list.length = 0;
    });
    await session.send("HeapProfiler.collectGarbage");
    const { usedSize } = await session.send("Runtime.getHeapUsage");
    return usedSize / 1e6;
  };
  await page.waitForTimeout(3000);
  const all = [await heap_MB()];
  for (let k = 0; k < SAMPLE_COUNT; k++) {
    await page.waitForTimeout((minutes * 60_000) / SAMPLE_COUNT);
    all.push(await heap_MB());
  }
  await page.close();
  const growth = (all[SAMPLE_COUNT] - all[0]) / minutes;
  return [
    { name: "heap at first", value: all[0], unit: "MB" },
    { name: `heap after ${minutes} min`, value: all[SAMPLE_COUNT], unit: "MB", all },
    { name: "heap growth", value: growth, unit: "MB/min" },
  ];
}
