import { changedPixels, expect, forest, frames, open, picture, SMALL, sway_m, test } from "../forest";

/** Wide enough for the toolbar. */
test.use({ deviceScaleFactor: 0.3, viewport: { width: 1000, height: 640 } });

for (const lookup of ["worker", "server"] as const) {
  test(`pausing stops the trees, and they go on afterwards (${lookup})`, { tag: lookup === "server" ? "@long" : [] }, async ({ page }) => {
    await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=14&lookup=${lookup}`);
    await forest(page);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(0.02);
    const pause = page.getByRole("button", { name: "Pause the motion" });
    await pause.click();
    await expect(pause).toHaveAttribute("aria-pressed", "true");
    await frames(page, 5);
    const before = await page.evaluate(() => window.galewood!.crownDisplacement_m);
    await frames(page, 10);
    expect(await page.evaluate(() => window.galewood!.crownDisplacement_m)).toEqual(before);
    await page.locator("canvas").first().press(" ");
    await expect(pause).toHaveAttribute("aria-pressed", "false");
    await expect.poll(() => page.evaluate(() => window.galewood!.crownDisplacement_m)).not.toEqual(before);
  });
}

test.describe("the picture", () => {
  test.use({ drawn: "always" });

  test("a single step moves the trees once", { tag: "@long" }, async ({ page }) => {
    await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=14`);
    await forest(page);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(0.02);
    await page.getByRole("button", { name: "Pause the motion" }).click();
    await frames(page, 5);
    const before = await page.evaluate(() => window.galewood!.crownDisplacement_m);
    await page.getByRole("button", { name: "Settings" }).click();
    await page.getByRole("button", { name: "Pause and step" }).click();
    await expect.poll(() => page.evaluate(() => window.galewood!.crownDisplacement_m)).not.toEqual(before);
    await frames(page, 5);
    const after = await picture(page);
    await frames(page, 10);
    expect(changedPixels(after, await picture(page), 0)).toBe(0);
  });
});

test("a visitor who prefers reduced motion finds the trees at rest", async ({ page }) => {
  await page.emulateMedia({ reducedMotion: "reduce" });
  await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=14`);
  await page.waitForFunction(() => (window.galewood?.trees.moving ?? 0) > 0);
  const pause = page.getByRole("button", { name: "Pause the motion" });
  await expect(pause).toHaveAttribute("aria-pressed", "true");
  await frames(page, 10);
  expect(await sway_m(page)).toBeLessThan(1e-6);
  await pause.click();
  await expect.poll(() => sway_m(page)).toBeGreaterThan(0.02);
});
