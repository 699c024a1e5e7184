/** What the motion costs: the same view of the same instances moving and standing still, by turns. */
import type { Browser, Page } from "@playwright/test";
import { openPage, untilMoving } from "./page";
import { type Figure, median } from "./report";

const ROUNDS = 5;
const BLOCK = { frames: 5, longest_ms: 6000 };

/** Mean time of a frame over a block, after two that are not counted. */
function block(page: Page, still: boolean): Promise<number> {
  return page.evaluate(
    async ({ still, frames, longest_ms }) => {
      const forest = window.galewood;
      if (!forest) throw new Error("no forest");
      forest.freeze(still);
      if (still) forest.pause();
      else forest.resume();
      const next = () => new Promise<number>((done) => requestAnimationFrame(done));
      await next();
      const begin_ms = await next();
      let now_ms = begin_ms;
      let counted = 0;
      while (counted < 2 || (counted < frames && now_ms - begin_ms < longest_ms) || now_ms - begin_ms < 400) {
        now_ms = await next();
        counted++;
      }
      return (now_ms - begin_ms) / counted;
    },
    { still, ...BLOCK },
  );
}

export async function measureFrames(
  browser: Browser,
  base: string,
  trees: number,
  most: number,
): Promise<Figure[]> {
  const page = await openPage(browser, base, `trees=${trees}`);
  await untilMoving(page);
  await block(page, true); // compiles what stands still
  const [moving, still]: number[][] = [[], []];
  for (let round = 0; round < ROUNDS; round++) {
    moving.push(await block(page, false));
    still.push(await block(page, true));
  }
  await page.evaluate(() => {
    window.galewood?.freeze(false);
    window.galewood?.resume();
    window.counted.bytes = [];
    window.counted.script_ms = [];
  });
  await page.waitForFunction(() => window.counted.bytes.length >= 8, undefined, { timeout: 120_000 });
  const counted = await page.evaluate(() => window.counted);
  const { triangles } = await page.evaluate(() => window.galewood?.statistics ?? { triangles: 0 });
  await page.close();
  const ratios = moving.map((value, round) => value / still[round]);
  const name = `${trees.toLocaleString("en")} trees: `;
  return [
    { name: `${name}frame moving / still`, value: median(ratios), unit: "", most, all: ratios },
    { name: `${name}frame moving`, value: median(moving), unit: "ms", all: moving },
    { name: `${name}frame still`, value: median(still), unit: "ms", all: still },
    {
      name: `${name}script a frame`,
      value: median(counted.script_ms),
      unit: "ms",
      most: 4,
      all: counted.script_ms,
    },
    { name: `${name}sent to the graphics card`, value: median(counted.bytes) / 1000, unit: "kB/frame" },
    { name: `${name}triangles in view`, value: triangles, unit: "" },
  ];
}
