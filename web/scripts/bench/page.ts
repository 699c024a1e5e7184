/** Instrumented page: script time of every frame, and bytes uploaded to the GPU. */
import type { Browser, Page } from "@playwright/test";

const PAGE_SIZE = { width: 320, height: 180 };
/** The browser has opened a tab, and ended the one before it, within this time. */
const TAB_MS = 1500;

/** Measurements, stored on the page's window. */
interface Counted {
  /** Main-thread time of each frame's callbacks, ms. */
  script_ms: number[];
  /** Interval between frames, ms. */
  frame_ms: number[];
  bytes: number[];
  firstMoving_ms: number | null;
}

declare global {
  interface Window {
    counted: Counted;
  }
}

/** Runs in the page before its scripts. */
function instrument(): void {
  const counted: Counted = { script_ms: [], frame_ms: [], bytes: [], firstMoving_ms: null };
  window.counted = counted;
  let last_ms = 0;
  let bytes = 0;
  let movingDrawn = false;
  const original = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (callback) =>
    original((now_ms) => {
      const begin_ms = performance.now();
      callback(now_ms);
      if (now_ms === last_ms) return;
      counted.script_ms.push(performance.now() - begin_ms);
      if (last_ms > 0) counted.frame_ms.push(now_ms - last_ms);
      counted.bytes.push(bytes);
      bytes = 0;
      last_ms = now_ms;
      if (counted.firstMoving_ms === null && movingDrawn) counted.firstMoving_ms = performance.now();
    });
  const proto = WebGL2RenderingContext.prototype as unknown as Record<string, (...a: unknown[]) => unknown>;
  // The ground is drawn so, after the trees.
  const drawElements = proto.drawElements;
  proto.drawElements = function (this: unknown, ...args: unknown[]) {
    const page = window.galewood;
    movingDrawn ||= page !== undefined && page.trees.moving > 0 && page.time_s > 0;
    return drawElements.apply(this, args);
  };
  const viewBytes = (value: unknown) => (ArrayBuffer.isView(value) ? value.byteLength : 0);
  const wrap = (name: string, size: (args: unknown[]) => number) => {
    const plain = proto[name];
    proto[name] = function (this: unknown, ...args: unknown[]) {
      bytes += size(args);
      return plain.apply(this, args);
    };
  };
  wrap("bufferData", (args) => viewBytes(args[1]));
  // (target, offset, data, first element, number of elements)
  wrap("bufferSubData", ([, , data, , length]) => {
    const view = data as Float32Array;
    return typeof length === "number" && length > 0 ? length * view.BYTES_PER_ELEMENT : viewBytes(data);
  });
  // (target, level, x, y, width, height, format, type, pixels): only this part is uploaded
  wrap("texSubImage2D", ([, , , , width, height, format, , data]) => {
    if (!ArrayBuffer.isView(data)) return 0;
    const channels = format === 0x1903 ? 1 : 4; // RED, or RGBA
    return Number(width) * Number(height) * channels * (data as Float32Array).BYTES_PER_ELEMENT;
  });
  wrap("texImage2D", (args) => viewBytes(args.at(-1)));
}

export async function openPage(browser: Browser, base: string, query: string): Promise<Page> {
  const page = await browser.newPage({ viewport: PAGE_SIZE });
  page.on("pageerror", (error) => console.error(`page: ${error.message}`));
  await page.addInitScript(instrument);
  await page.waitForTimeout(TAB_MS);
  await page.goto(`${base}/?panel=0&quality=low&flutter=0&speed=8&${query}`);
  return page;
}

/** Waits until every tree moves. */
export async function untilMoving(page: Page): Promise<void> {
  await page.waitForFunction(
    () => window.galewood?.allPlanted && window.galewood.trees.moving > 0 && window.galewood.time_s > 0.5,
    undefined,
    { timeout: 180_000 },
  );
}
