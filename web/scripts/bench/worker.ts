/**
 * Worker time at 10,000 trees, with one table step of near trees per frame, and at 100,000 with sixty frames per second.
 * Nothing is drawn meanwhile, because the software rasteriser would compete for the processor.
 */
import type { Browser, Page } from "@playwright/test";
import { TICK_HZ } from "../../player/src/core/constants";
import { openPage, untilMoving } from "./page";
import { type Figure, median } from "./report";

const TREE_COUNT = 10_000;
const FRAME_COUNT = 90;
const FRAME_S = 1 / TICK_HZ;
const LARGE_FOREST = 100_000;
const DISPLAY_S = 1 / 60;
const DEFAULT_METHOD = "modal";
const MODELS = ["cosine", "perlin", "spectral", "navier-stokes"] as const;

/** Worker times of the next frames (ms), at this frame rate. */
function sample(page: Page, frames: number, frame_s = FRAME_S) {
  return page.evaluate(
    async ([wanted, frame_s]) => {
      const forest = window.galewood;
      if (!forest) throw new Error("no forest");
      const times: { wind_ms: number; total_ms: number }[] = [];
      while (times.length < wanted) {
        const begin_ms = performance.now();
        await forest.step(frame_s, false);
        times.push({ ...forest.statistics.work });
        const left_ms = 1000 * frame_s - (performance.now() - begin_ms);
        await new Promise((done) => setTimeout(done, Math.max(0, left_ms)));
      }
      return times;
    },
    [frames, frame_s],
  );
}

/** The records arrive later than the tables. */
async function untilPaper(page: Page): Promise<void> {
  await page.waitForFunction(
    () => window.galewood !== undefined && window.galewood.paperTrees === window.galewood.trees.moving,
    undefined,
    { timeout: 180_000 },
  );
}

async function method(browser: Browser, base: string, name: string): Promise<Figure[]> {
  const page = await openPage(browser, base, `trees=${TREE_COUNT}&method=${name}`);
  await untilMoving(page);
  if (name === "paper") await untilPaper(page);
  await page.evaluate(() => window.galewood?.sleep(true));
  await sample(page, 60); // warm-up, until the trees move
  const all = (await sample(page, FRAME_COUNT)).map(({ total_ms }) => total_ms);
  const figures: Figure[] = [
    {
      name: `worker, ${name}, 10,000 trees`,
      value: median(all),
      unit: "ms/frame",
      all,
      ...(name === DEFAULT_METHOD && { most: 8 }),
    },
  ];
  if (name === DEFAULT_METHOD) for (const model of MODELS) figures.push(await wind(page, model));
  await page.close();
  return figures;
}

async function wind(page: Page, model: string): Promise<Figure> {
  await page.evaluate((model) => {
    // each model has fields of its own, and refuses those of another
    const { waves: _, length_scale_m: __, ...plain } = window.galewood?.wind ?? ({} as never);
    const own = model === "cosine" ? {} : { length_scale_m: 20 };
    window.galewood?.setWind({ ...plain, model, ...own });
  }, model);
  await sample(page, 150); // transition and warm-up
  const times = (await sample(page, FRAME_COUNT)).map(({ wind_ms }) => wind_ms);
  return {
    name: `worker, wind ${model}, 10,000 trees`,
    value: median(times),
    unit: "ms/frame",
    most: 3,
    all: times,
  };
}

/** Sixty frames per second of a forest whose distant trees are stepped less often: the time of the slowest worker. */
async function levels(browser: Browser, base: string, trees: number, workers: number): Promise<Figure> {
  const page = await openPage(browser, base, `trees=${trees}&workers=${workers}`);
  await untilMoving(page);
  await page.evaluate(() => window.galewood?.sleep(true));
  await sample(page, 120, DISPLAY_S);
  const all = (await sample(page, FRAME_COUNT, DISPLAY_S)).map(({ total_ms }) => total_ms);
  await page.close();
  const who = workers === 1 ? "worker" : `slowest of ${workers} workers`;
  const name = `${who}, ${trees.toLocaleString("en")} trees, 60 Hz`;
  return { name, value: median(all), unit: "ms/frame", all, most: 10 };
}

export async function measureWorker(browser: Browser, base: string): Promise<Figure[]> {
  return [
    ...(await method(browser, base, DEFAULT_METHOD)),
    ...(await method(browser, base, "paper")),
    await levels(browser, base, TREE_COUNT, 1),
    await levels(browser, base, LARGE_FOREST, 1),
    await levels(browser, base, LARGE_FOREST, 2),
  ];
}
