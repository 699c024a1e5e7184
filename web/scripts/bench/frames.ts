/** Cost of the motion: the same view of the same instances, alternately moving and static. */
import type { Browser, CDPSession, Page } from "@playwright/test";
import { openPage, untilMoving } from "./page";
import { type Figure, median } from "./report";
import { scriptTimes_ms } from "./script";

const ROUND_COUNT = 5;
/** At the lowest quality, shadow maps are drawn in every third frame: six frames give each block the same number. */
const FRAME_BLOCK = { frames: 6, longest_ms: 20_000, least_ms: 400 };

interface Cost {
  readonly frame_ms: number;
  /** CPU time of all browser processes: on a busy machine more reliable than wall time. */
  readonly processor_ms: number;
}

export async function processor_ms(session: CDPSession): Promise<number> {
  const { processInfo } = await session.send("SystemInfo.getProcessInfo");
  return processInfo.reduce((sum, { cpuTime }) => sum + 1000 * cpuTime, 0);
}

/** Mean cost of a frame in a block. */
async function block(page: Page, session: CDPSession, still: boolean): Promise<Cost> {
  await draw(page, still, { frames: 1, longest_ms: 0, least_ms: 0 });
  const before_ms = await processor_ms(session);
  const { frames, time_ms } = await draw(page, still, FRAME_BLOCK);
  const used_ms = (await processor_ms(session)) - before_ms;
  return { frame_ms: time_ms / frames, processor_ms: used_ms / frames };
}

/** Draws one block of frames. The time is taken when the graphics have finished, both before and after the block. */
function draw(page: Page, still: boolean, length: typeof FRAME_BLOCK) {
  return page.evaluate(
    async ({ still, frames, longest_ms, least_ms }) => {
      const forest = window.galewood;
      if (!forest) throw new Error("no forest");
      forest.freeze(still);
      if (still) forest.pause();
      else forest.resume();
      const gl = document.querySelector<HTMLCanvasElement>("#view")?.getContext("webgl2");
      if (!gl) throw new Error("no graphics");
      const next = () => new Promise<number>((done) => requestAnimationFrame(done));
      /** Reading a pixel waits for all that has been drawn. */
      const finished_ms = () => {
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        return performance.now();
      };
      await next();
      const begin_ms = finished_ms();
      let now_ms = begin_ms;
      let counted = 0;
      const wanted = () =>
        counted < 1 || (counted < frames && now_ms - begin_ms < longest_ms) || now_ms - begin_ms < least_ms;
      while (wanted()) {
        await next();
        now_ms = finished_ms();
        counted++;
      }
      return { frames: counted, time_ms: now_ms - begin_ms };
    },
    { still, ...length },
  );
}

/** Waits for the pictures of distant trees, which take most of a frame while they are drawn. */
async function untilDrawnFromPictures(page: Page): Promise<void> {
  const ready = () => window.galewood?.statistics.impostors.ready ?? false;
  await page.waitForFunction(ready, undefined, { timeout: 600_000, polling: 500 });
}

export async function measureFrames(
  browser: Browser,
  base: string,
  trees: number,
  most: number,
): Promise<Figure[]> {
  const page = await openPage(browser, base, `trees=${trees}`);
  await untilMoving(page);
  await untilDrawnFromPictures(page);
  const session = await browser.newBrowserCDPSession();
  await block(page, session, true); // compiles the static shaders
  const [moving, still]: Cost[][] = [[], []];
  for (let round = 0; round < ROUND_COUNT; round++) {
    moving.push(await block(page, session, false));
    still.push(await block(page, session, true));
  }
  await session.detach();
  await page.evaluate(() => {
    window.galewood?.freeze(false);
    window.galewood?.resume();
    window.counted.bytes = [];
    window.counted.script_ms = [];
  });
  await page.waitForFunction(() => window.counted.bytes.length >= 8, undefined, { timeout: 120_000 });
  const counted = await page.evaluate(() => window.counted);
  const script_ms = await scriptTimes_ms(browser, page, 10);
  const { triangles, work } = await page.evaluate(
    () => window.galewood?.statistics ?? { triangles: 0, work: { total_ms: Number.NaN } },
  );
  await page.close();
  const name = `${trees.toLocaleString("en")} trees: `;
  const ratio = (cost: keyof Cost) => moving.map((value, round) => value[cost] / still[round][cost]);
  const figure = (what: string, all: number[], unit: string, most?: number): Figure => ({
    name: `${name}${what}`,
    value: median(all),
    unit,
    all,
    ...(most !== undefined && { most }),
  });
  return [
    figure("frame moving / still", ratio("frame_ms"), "", most),
    figure("processor time moving / still", ratio("processor_ms"), "", most),
    figure(
      "frame moving",
      moving.map(({ frame_ms }) => frame_ms),
      "ms",
    ),
    figure(
      "frame still",
      still.map(({ frame_ms }) => frame_ms),
      "ms",
    ),
    figure("script a frame, processor time", script_ms, "ms", 4),
    figure("script a frame, beside the rasteriser", counted.script_ms, "ms"),
    figure(
      "sent to the graphics card",
      counted.bytes.map((bytes) => bytes / 1000),
      "kB/frame",
    ),
    figure("triangles in view", [triangles], ""),
    figure("worker beside the rasteriser, all steps of a frame", [work.total_ms], "ms/frame"),
  ];
}
