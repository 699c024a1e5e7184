/**
 * The worker's time at 10,000 trees, with a camera that sees none of them and few pixels: where no graphics card
 * draws, the rasteriser would take the worker's processor.
 */
import type { Browser, Page } from "@playwright/test";
import { openPage, untilMoving } from "./page";
import { type Figure, median } from "./report";

const TREES = 10_000;
const FRAMES = 60;
const SHARPNESS = 0.2;
const MODELS = ["cosine", "perlin", "spectral", "navier-stokes"] as const;

/** The worker's times of the next frames, ms. */
function sample(page: Page, frames: number) {
  return page.evaluate(async (wanted) => {
    const times: { wind_ms: number; total_ms: number; frame_s: number }[] = [];
    let before_s = window.galewood?.time_s ?? 0;
    while (times.length < wanted) {
      await new Promise(requestAnimationFrame);
      const forest = window.galewood;
      if (!forest || forest.time_s === before_s) continue;
      const { wind_ms, total_ms } = forest.statistics.work;
      times.push({ wind_ms, total_ms, frame_s: forest.time_s - before_s });
      before_s = forest.time_s;
    }
    return times;
  }, frames);
}

const away = (page: Page) =>
  page.evaluate(() => window.galewood?.look({ x: 0, above: 40, z: 560 }, { x: 0, above: 40, z: 700 }));

async function method(browser: Browser, base: string, name: string): Promise<Figure[]> {
  const page = await openPage(browser, base, `trees=${TREES}&method=${name}`, SHARPNESS);
  await untilMoving(page);
  await away(page);
  await sample(page, 40);
  const times = await sample(page, FRAMES);
  const figures: Figure[] = [
    {
      name: `worker, ${name}, 10,000 trees`,
      value: median(times.map(({ total_ms }) => total_ms)),
      unit: "ms/frame",
      most: 8,
      all: times.map(({ total_ms }) => total_ms),
    },
    {
      name: `worker, ${name}: a frame advances`,
      value: 1000 * median(times.map(({ frame_s }) => frame_s)),
      unit: "ms",
    },
  ];
  if (name === "tangent") for (const model of MODELS) figures.push(await wind(page, model));
  await page.close();
  return figures;
}

async function wind(page: Page, model: string): Promise<Figure> {
  await page.evaluate((model) => {
    const { waves: _, ...plain } = window.galewood?.wind ?? ({} as never);
    const scale = model === "cosine" ? {} : { length_scale_m: 20 };
    window.galewood?.setWind({ ...plain, model, ...scale });
  }, model);
  await sample(page, 50); // glides over, and compiles
  const times = (await sample(page, FRAMES)).map(({ wind_ms }) => wind_ms);
  return {
    name: `worker, wind ${model}, 10,000 trees`,
    value: median(times),
    unit: "ms/frame",
    most: 3,
    all: times,
  };
}

export async function measureWorker(browser: Browser, base: string): Promise<Figure[]> {
  return [...(await method(browser, base, "tangent")), ...(await method(browser, base, "paper"))];
}
