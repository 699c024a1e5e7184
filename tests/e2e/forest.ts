/** Helpers of the page tests: open the page, wait for trees, compare pictures. */
import { test as base, type Browser, expect, type Page } from "@playwright/test";
import { PNG } from "pngjs";

export { expect };

export const SMALL = "panel=0&quality=low&trees=6&flutter=0&background=0";

/**
 * Which frames of a page are drawn. This processor draws them, which costs far more than all else that a page does:
 * `always` is for tests that look at pictures, `sometimes` for what no such test shows, so that the graphics library
 * checks those draws too, `never` for all others. What a page computes in a frame is the same.
 */
type Drawn = "always" | "sometimes" | "never";

/** Runs in every page before its scripts: few frames a second, and only the first of every `drawEvery` is drawn. */
function drawSlowly(drawEvery: number): void {
  const every_ms = 180;
  const soon = window.requestAnimationFrame.bind(window);
  const timers = new Map<number, number>();
  let last = 0;
  let called = 0;
  window.requestAnimationFrame = (callback) => {
    const id = ++last;
    const run = (now_ms: number) => {
      if (!timers.delete(id)) return;
      called++;
      callback(now_ms);
    };
    timers.set(id, window.setTimeout(() => soon(run), every_ms - (performance.now() % every_ms)));
    return id;
  };
  window.cancelAnimationFrame = (id) => {
    window.clearTimeout(timers.get(id));
    timers.delete(id);
  };
  if (drawEvery === 1) return;
  const graphics = WebGL2RenderingContext.prototype;
  for (const name of ["clear", "drawArrays", "drawArraysInstanced", "drawElements", "drawElementsInstanced"] as const) {
    const draw = graphics[name] as (...what: number[]) => void;
    Object.assign(graphics, {
      [name](this: WebGL2RenderingContext, ...what: number[]) {
        if (called % drawEvery === 0) draw.apply(this, what);
      },
    });
  }
  const { getExtension } = graphics;
  graphics.getExtension = function get(this: WebGL2RenderingContext, name: string) {
    const found = getExtension.call(this, name as never) as WEBGL_multi_draw | null;
    if (name !== "WEBGL_multi_draw" || !found) return found;
    type Call = Parameters<WEBGL_multi_draw["multiDrawElementsInstancedWEBGL"]>;
    const drawn = (...what: Call) => {
      if (called % drawEvery === 0) found.multiDrawElementsInstancedWEBGL(...what);
    };
    return { multiDrawElementsInstancedWEBGL: drawn };
  } as typeof getExtension;
  // Nobody sees the ground either, which keeps its mean colours.
  const Started = window.Worker;
  const silent = { terminate() {}, postMessage() {} };
  window.Worker = function start(address: string | URL, options?: WorkerOptions) {
    return String(address).includes("painting.worker") ? silent : new Started(address, options);
  } as unknown as typeof Worker;
}

/** Prime, because a page may ask for several callbacks a frame; all of them take their turns. */
const DRAW_EVERY: Record<Drawn, number> = { always: 1, sometimes: 19, never: Number.POSITIVE_INFINITY };

interface Watched {
  drawn: Drawn;
  /** What the console of the page shows: the test fails if these are errors or warnings. */
  quiet: string[];
}

const pathOf = (address: string) => (URL.canParse(address) ? new URL(address).pathname : address);

export const test = base.extend<Watched>({
  drawn: ["never", { option: true }],
  quiet: [
    async ({ context, page, drawn }, use) => {
      await context.addInitScript(drawSlowly, DRAW_EVERY[drawn]);
      const complaints: string[] = [];
      page.on("console", (message) => {
        if (message.type() !== "error" && message.type() !== "warning") return;
        complaints.push(`${message.text()} (${pathOf(message.location().url)})`);
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

/** A page of another visitor, in a window of its own: browsers show a page behind another one frame per second. */
export async function visitor(browser: Browser): Promise<Page> {
  const context = await browser.newContext({ viewport: { width: 320, height: 180 } });
  await context.addInitScript(drawSlowly, DRAW_EVERY.never);
  return context.newPage();
}

export const open = (page: Page, query: string) => page.goto(`${process.env.BASE_URL}/?${query}`);

/** Waits until all trees are displayed and move, and the controls are there. */
export async function forest(page: Page): Promise<void> {
  await page.waitForFunction(
    () => window.galewood?.allPlanted && window.galewood.trees.moving > 0 && window.galewood.time_s > 0.2,
  );
  await expect(page.locator("body")).not.toHaveClass(/opening/);
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

/**
 * Advances the forest of a page that computes its motion itself by a span of its own time, as fast as it can and without
 * drawing. Returns the mean displacement of the crowns (x, y, z)
 * after each step, and the largest of the selected tree's tip.
 */
export const elapse = (page: Page, span_s: number) =>
  page.evaluate(async (span) => {
    const galewood = window.galewood!;
    const crowns_m: [number, number, number][] = [];
    let tip_m = 0;
    galewood.sleep(true);
    const end_s = galewood.time_s + span;
    while (galewood.time_s < end_s) {
      await galewood.step(0.1, false);
      crowns_m.push([...galewood.crownDisplacement_m]);
      tip_m = Math.max(tip_m, galewood.picked?.tip_m ?? 0);
    }
    galewood.sleep(false);
    return { crowns_m, tip_m };
  }, span_s);

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
