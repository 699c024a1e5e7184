import type { Page } from "@playwright/test";
import { expect, forest, open, test } from "../forest";

/** Blocks of the page that must not cover one another. */
const BLOCKS =
  "#title, #cards .card, #instruments, #actions > button, #playback, #tools, #panel, .anemometer, #scenery, #winds, " +
  ".toast, #hint, #exaggerated, .sharing";

interface Box {
  name: string;
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** The visible part of every block: what its scrolling ancestors show of it. */
const visibleBoxes = (page: Page) =>
  page.evaluate((blocks) => {
    const shown: Box[] = [];
    for (const element of document.querySelectorAll<HTMLElement>(blocks)) {
      let { left, top, right, bottom } = element.getBoundingClientRect();
      if (!element.checkVisibility()) continue;
      for (let around = element.parentElement; around; around = around.parentElement) {
        if (getComputedStyle(around).overflowY === "visible" || around === document.body) continue;
        const box = around.getBoundingClientRect();
        left = Math.max(left, box.left);
        top = Math.max(top, box.top);
        right = Math.min(right, box.right);
        bottom = Math.min(bottom, box.bottom);
      }
      const name = element.id || element.className || element.textContent || "";
      if (right - left > 1 && bottom - top > 1) shown.push({ name, left, top, right, bottom });
    }
    return shown;
  }, BLOCKS);

/** Pairs of blocks that cover each other, and blocks that leave the window. */
async function faults(page: Page): Promise<string[]> {
  const boxes = await visibleBoxes(page);
  const { width, height } = page.viewportSize()!;
  const found = boxes
    .filter(({ left, top, right, bottom }) => left < -1 || top < -1 || right > width + 1 || bottom > height + 1)
    .map(({ name }) => `${name} leaves the window`);
  for (const [k, a] of boxes.entries())
    for (const b of boxes.slice(k + 1)) {
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 1 && down > 1) found.push(`${a.name} covers ${b.name}`);
    }
  return found;
}

/** Everything that can be on the page at once, besides the panels. */
async function fill(page: Page): Promise<void> {
  await page.evaluate(() => {
    for (let y = 20; y < innerHeight && !window.galewood!.picked; y += 10)
      for (let x = 5; x < innerWidth && !window.galewood!.picked; x += 10) window.galewood!.pick(x, y);
    const card = document.createElement("article");
    card.className = "card";
    card.innerHTML = "<h2>Ash<span>40 %</span></h2><p>Simulating winds</p><div class='bar'><i></i></div>";
    document.getElementById("progress")!.append(card);
    const toast = document.createElement("div");
    toast.className = "toast bad";
    toast.innerHTML = "<strong>The server is not connected.</strong><button>Dismiss</button><p>Check it.</p>";
    document.getElementById("toasts")!.append(toast);
    const meter = document.querySelector<HTMLElement>(".anemometer")!;
    meter.hidden = false;
    meter.querySelector<HTMLElement>(".plots")!.style.height = "290px";
    document.getElementById("hint")!.hidden = false;
  });
  await expect(page.locator(".picked")).toBeAttached();
}

test.use({ deviceScaleFactor: 0.5 });

/** A phone and a laptop are always tested, what is between them by `make test-long`. */
const tagOf = (width: number) => (width === 390 || width === 1280 ? [] : "@long");

for (const [width, height] of [[390, 844], [800, 600], [900, 700], [1280, 720]] as const) {
  test(`nothing covers anything else at ${width} × ${height} with everything open`, { tag: tagOf(width) }, async ({ page }) => {
    await page.setViewportSize({ width, height });
    await open(page, "quality=low&trees=6&speed=3&motion=2&background=0");
    await forest(page);
    await page.evaluate(() => window.galewood!.sleep(true)); // leave the processor to the test
    expect(await faults(page)).toEqual([]);
    await fill(page);
    for (const name of ["Settings", "Wind", "Tools"]) {
      const toggle = page.locator("#actions").getByRole("button", { name, exact: true });
      if (!(await toggle.isVisible())) continue;
      if ((await toggle.getAttribute("aria-expanded")) === "false") await toggle.click();
      await expect(toggle).toBeInViewport();
      expect(await faults(page), name).toEqual([]);
    }
    const views = page.getByRole("button", { name: "Views" });
    if (await views.isVisible()) await views.click();
    await page.evaluate(() => {
      for (const details of document.querySelectorAll("details")) details.open = true;
    });
    expect(await faults(page)).toEqual([]);
    // The forest stays visible on a phone.
    if (width < 760) {
      const covered = (await visibleBoxes(page)).reduce((sum, box) => sum + (box.bottom - box.top) * (box.right - box.left), 0);
      expect(covered / (width * height)).toBeLessThan(0.75);
    }
  });
}

test.describe("for fingers", () => {
  test.use({ hasTouch: true, isMobile: true });

  for (const [width, height] of [[390, 844], [900, 700]] as const) {
    test(`all targets are at least 44 px high at ${width} px`, { tag: tagOf(width) }, async ({ page }) => {
      await page.setViewportSize({ width, height });
      await open(page, "quality=low&trees=4&speed=3&background=0");
      await forest(page);
      await page.evaluate(() => window.galewood!.sleep(true));
      for (const name of ["Wind", "Tools", "Settings"]) {
        const toggle = page.locator("#actions").getByRole("button", { name, exact: true });
        if ((await toggle.getAttribute("aria-expanded")) === "false") await toggle.tap();
        const small = await page.evaluate(() =>
          [...document.querySelectorAll<HTMLElement>("#hud :is(button, select, summary, input[type=range])")]
            .filter((target) => target.checkVisibility())
            .map((target) => ({ name: target.textContent || target.title || target.className, box: target.getBoundingClientRect() }))
            .filter(({ box }) => box.height < 43.5)
            .map(({ name, box }) => `${name}: ${box.height.toFixed(0)} px`),
        );
        expect(small, name).toEqual([]);
      }
    });
  }
});

for (const deviceScaleFactor of [1, 2]) {
  test.describe(`the plots at a pixel ratio of ${deviceScaleFactor}`, () => {
    test.use({ deviceScaleFactor, viewport: { width: 800, height: 600 } });

    test("no label is clipped", { tag: "@long" }, async ({ page }) => {
      await page.addInitScript(() => {
        const faults: string[] = [];
        Object.assign(window, { labels: { drawn: 0, faults } });
        const original = CanvasRenderingContext2D.prototype.fillText;
        CanvasRenderingContext2D.prototype.fillText = function fillText(text: string, x: number, y: number) {
          if (!this.canvas.closest?.(".uplot") || text === "") return original.call(this, text, x, y);
          const { actualBoundingBoxLeft, actualBoundingBoxRight } = this.measureText(text);
          const at = this.getTransform().transformPoint({ x, y });
          const [left, right] = [at.x - actualBoundingBoxLeft, at.x + actualBoundingBoxRight];
          const labels = (window as unknown as { labels: { drawn: number } }).labels;
          labels.drawn++;
          if (left < 0 || right > this.canvas.width) faults.push(`${text}: ${left.toFixed(0)} to ${right.toFixed(0)}`);
          original.call(this, text, x, y);
        };
      });
      // Weak wind: the labels of the tip's displacement have the most digits.
      for (const speed of [1, 60]) {
        await open(page, `quality=low&trees=3&speed=${speed}&gust=0.9&background=0`);
        await forest(page);
        await page.getByRole("button", { name: "Anemometer" }).click();
        await page.mouse.click(420, 480);
        const labels = () =>
          page.evaluate(() => (window as unknown as { labels: { drawn: number; faults: string[] } }).labels);
        await expect.poll(async () => (await labels()).drawn).toBeGreaterThan(20);
        expect((await labels()).faults).toEqual([]);
      }
    });
  });
}
