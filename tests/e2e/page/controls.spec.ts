import type { Page } from "@playwright/test";
import { elapse, expect, forest, frames, open, SMALL, sway_m, test } from "../forest";

const panelled = `${SMALL.replace("panel=0", "panel=1")}&speed=9`;
const tool = (page: Page, name: string) =>
  page.evaluate((label) => document.querySelector<HTMLButtonElement>(`[aria-label='${label}']`)?.click(), name);
const wind = (page: Page) => page.evaluate(() => window.galewood!.wind);

/** Picks the first tree found in the picture. */
async function pickTree(page: Page): Promise<void> {
  const found = await page.evaluate(() => {
    for (let y = 20; y < innerHeight; y += 10)
      for (let x = 5; x < innerWidth; x += 10) if (window.galewood!.pick(x, y)?.moves) return true;
    return false;
  });
  expect(found).toBe(true);
}

async function setHidden(page: Page, hidden: boolean): Promise<void> {
  await page.evaluate((state) => {
    Object.defineProperty(document, "visibilityState", { configurable: true, get: () => state });
    document.dispatchEvent(new Event("visibilitychange"));
  }, hidden ? "hidden" : "visible");
}

test("changes of wind and settings can be undone and redone", async ({ page }) => {
  await open(page, panelled);
  await forest(page);
  const first = await wind(page);
  await page.getByRole("button", { name: "Storm front" }).evaluate((button: HTMLButtonElement) => button.click());
  const storm = await wind(page);
  expect(storm).not.toEqual(first);
  await page.getByRole("button", { name: "Winter" }).evaluate((button: HTMLButtonElement) => button.click());
  await page.locator("#view").press("Control+z");
  await expect(page.locator("[data-season='winter']")).toHaveAttribute("aria-pressed", "false");
  expect(await wind(page)).toEqual(storm);
  await page.locator("#view").press("Control+z");
  expect(await wind(page)).toEqual(first);
  await tool(page, "Redo (Ctrl+Y)");
  expect(await wind(page)).toEqual(storm);
  await tool(page, "Undo (Ctrl+Z)");
  expect(await wind(page)).toEqual(first);
  await expect(page.locator("[aria-label='Undo (Ctrl+Z)']")).toBeDisabled();
});

test("the first hint is shown once, until the first action", async ({ page }) => {
  await page.setViewportSize({ width: 800, height: 450 });
  await open(page, panelled);
  await expect(page.getByText("Drag the arrow. Click a tree. Pull a branch.")).toBeVisible();
  await page.locator("#title").click({ force: true });
  await expect(page.getByText("Drag the arrow. Click a tree. Pull a branch.")).toBeHidden();
  await open(page, panelled);
  await forest(page);
  await expect(page.getByText("Drag the arrow. Click a tree. Pull a branch.")).toBeHidden();
});

test("exaggerated motion is labelled, and leaves the figures as they are", async ({ page }) => {
  const sway = async (query: string) => {
    await open(page, `${panelled}&gust=0&${query}`);
    await forest(page);
    await elapse(page, 8);
    await page.getByRole("button", { name: "Pause the motion" }).evaluate((button: HTMLButtonElement) => button.click());
    await frames(page, 3);
    return sway_m(page);
  };
  const plain = await sway("motion=1");
  await expect(page.locator("#exaggerated")).toBeHidden();
  const exaggerated = await sway("motion=2");
  await expect(page.locator("#exaggerated")).toHaveText("Motion exaggerated ×2");
  expect(Math.abs(exaggerated / plain - 1)).toBeLessThan(0.25); // not twice as much
});

test.describe("overlays", () => {
  test.use({ deviceScaleFactor: 0.3, drawn: "sometimes" });

  test("overlays are drawn on the picked tree", { tag: "@long" }, async ({ page }) => {
    await page.setViewportSize({ width: 640, height: 480 });
    await open(page, panelled);
    await forest(page);
    await pickTree(page);
    const choice = page.getByLabel("Show on the tree");
    const note = page.locator(".overlay-note");
    const shown = () => page.evaluate(() => window.galewood!.overlay);
    for (const [kind, words] of [
      ["skeleton", /\d+ points/],
      ["tetrahedra", /[\d,]+ tetrahedra/],
      ["modes", /^Mode 1 of \d+: 0\.\d+ Hz/],
    ] as const) {
      await choice.selectOption(kind);
      await expect(note).toHaveText(words);
      expect(await shown()).toBe(kind);
    }
    await page.getByRole("button", { name: "Next mode" }).click();
    await expect(note).toHaveText(/^Mode 2 of/);
    await choice.selectOption("wind");
    await expect.poll(shown).toBe("wind");
    await choice.selectOption("strain");
    await expect(note).toHaveText(/^Steady wind of 15 m\/s, in leaf.* mm\/m, .* no substitute for an inspection/);
    expect(await shown()).toBe("strain");
    await choice.selectOption("error");
    await expect(note).toContainText("Check accuracy");
    await choice.selectOption("none");
    await expect.poll(shown).toBe("none");
  });
});

test("a forest is shared with another page: both see who is here, and the same wind", async ({ page, context }) => {
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.setViewportSize({ width: 480, height: 360 });
  await open(page, panelled);
  await forest(page);
  await tool(page, "Share this forest");
  await expect(page.locator(".sharing")).toContainText("Nobody else is here yet.");
  const link = await page.evaluate(() => navigator.clipboard.readText());
  expect(new URL(link).searchParams.get("share")).toMatch(/^[a-z2-9]{12}$/);
  const other = await context.newPage();
  await other.goto(link);
  await forest(other);
  await expect(other.locator(".sharing")).toContainText("2 people are here");
  await expect(page.locator(".sharing")).toContainText("2 people are here");
  await other.evaluate(() => window.galewood!.setWind({ ...window.galewood!.wind, mean_speed_m_s: 3.5 }));
  await expect.poll(async () => (await wind(page)).mean_speed_m_s).toBe(3.5);
  await other.close();
  await expect(page.locator(".sharing")).toContainText("Nobody else is here yet.");
});

for (const share of ["", "&share=hidden-tab"]) {
  test(`a hidden page draws nothing and receives nothing${share && ", also of a shared forest"}`, { tag: "@long" }, async ({ page }) => {
    let received = 0;
    let closed = 0;
    page.on("websocket", (socket) => {
      socket.on("framereceived", ({ payload }) => {
        if (payload.length > 150) received++;
      });
      socket.on("close", () => closed++);
    });
    await open(page, `${panelled}&lookup=server${share}`);
    await forest(page);
    await expect.poll(() => page.evaluate(() => window.galewood!.connection.state)).toBe("live");
    closed = 0; // each planting has a socket of its own
    await setHidden(page, true);
    const drawn = await page.evaluate(() => window.galewood!.frame);
    // Poll until nothing arrives for two seconds.
    await expect
      .poll(async () => {
        const before = received;
        await new Promise((done) => setTimeout(done, 2000));
        return received - before;
      })
      .toBe(0);
    expect(await page.evaluate(() => window.galewood!.frame)).toBe(drawn);
    expect(closed).toBe(share ? 1 : 0);
    await setHidden(page, false);
    const before = received;
    await expect.poll(() => received).toBeGreaterThan(before + 5);
    await frames(page, 5);
    await expect.poll(() => page.evaluate(() => window.galewood!.connection.state)).toBe("live");
  });
}

test("an embedded forest has a pause button and a link, and nothing else", async ({ page }) => {
  await open(page, "embed=1&trees=4&quality=low&speed=9");
  await forest(page);
  const visible = await page.evaluate(() =>
    [...document.querySelectorAll<HTMLElement>("button, a, input, select")]
      .filter((control) => control.checkVisibility())
      .map((control) => control.textContent),
  );
  expect(visible).toEqual(["Pause", "Galewood ↗"]);
  await page.getByRole("button", { name: "Pause the motion" }).click();
  await frames(page, 3);
  const before = await sway_m(page);
  await frames(page, 5);
  expect(await sway_m(page)).toBe(before);
  const whole = new URL((await page.getByRole("link").getAttribute("href"))!);
  expect([whole.searchParams.get("embed"), whole.searchParams.get("trees")]).toEqual([null, "4"]);
});

test("the wind is heard once it is turned on, and not while the motion is paused", { tag: "@long" }, async ({ page }) => {
  await open(page, panelled);
  await forest(page);
  const loudness = () => page.evaluate(() => window.galewood!.loudness);
  expect(await loudness()).toBe(0);
  await tool(page, "Sound of the wind");
  await expect.poll(loudness).toBeGreaterThan(0.01);
  await page.locator("#view").press(" ");
  await expect.poll(loudness).toBe(0);
});

test.describe("graphics", () => {
  test.use({ deviceScaleFactor: 0.3, drawn: "sometimes" });

  test("a lost graphics context is explained, and the forest comes back without warnings", async ({ page }) => {
    await open(page, panelled);
    await forest(page);
    await page.evaluate(() => {
      const canvas = document.getElementById("view") as HTMLCanvasElement;
      const loss = canvas.getContext("webgl2")!.getExtension("WEBGL_lose_context")!;
      Object.assign(window, { loss });
      loss.loseContext();
    });
    await expect(page.getByRole("alert")).toContainText("The browser has reset its graphics.");
    const drawn = await page.evaluate(() => window.galewood!.frame);
    await page.evaluate(() => (window as unknown as { loss: WEBGL_lose_context }).loss.restoreContext());
    await page.waitForFunction((before) => window.galewood!.frame > before + 10, drawn);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(0.01);
  });

  test("graphics that are lost while the first picture is drawn come back as well", async ({ page }) => {
    await page.addInitScript(() => {
      const { prototype } = WebGL2RenderingContext;
      const { fenceSync } = prototype;
      prototype.fenceSync = function (...args) {
        prototype.fenceSync = fenceSync;
        const loss = this.getExtension("WEBGL_lose_context");
        this.canvas.addEventListener("webglcontextlost", () => setTimeout(() => loss?.restoreContext(), 200));
        const sync = fenceSync.apply(this, args);
        loss?.loseContext();
        return sync;
      };
    });
    await open(page, panelled);
    await page.waitForFunction(() => (window.galewood?.frame ?? 0) > 10);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(0.01);
  });
});
