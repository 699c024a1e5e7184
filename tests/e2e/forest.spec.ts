import { changedPixels, expect, forest, frames, open, picture, SMALL, sway_m, test } from "./forest";

test("the page shows a forest", async ({ page }) => {
  await open(page, `${SMALL}&speed=10`);
  await forest(page);
  const colours = new Set<number>();
  const { data } = await picture(page);
  for (let i = 0; i < data.length; i += 4) colours.add((data[i] >> 3) * 1024 + (data[i + 1] >> 3) * 32 + (data[i + 2] >> 3));
  expect(colours.size).toBeGreaterThan(200);
  expect(await page.evaluate(() => window.galewood!.readySpecies.length)).toBeGreaterThan(0);
});

test("a strong wind moves crowns and pixels", async ({ page }) => {
  await open(page, `${SMALL}&speed=18`);
  await forest(page);
  const before = await picture(page);
  await expect.poll(() => sway_m(page)).toBeGreaterThan(0.02);
  await frames(page, 3);
  expect(changedPixels(before, await picture(page), 12)).toBeGreaterThan(100);
});

for (const lookup of ["worker", "server"] as const) {
  test(`still air: nothing moves, to the last pixel (${lookup})`, async ({ page }) => {
    await open(page, `${SMALL}&speed=0&lookup=${lookup}`);
    await forest(page);
    await frames(page, 4);
    const before = await picture(page);
    const time_s = await page.evaluate(() => window.galewood!.time_s);
    await page.waitForFunction((from) => window.galewood!.time_s > from + 1, time_s);
    expect(changedPixels(before, await picture(page), 0)).toBe(0);
    expect(await sway_m(page)).toBeLessThan(1e-4);
  });

  test(`the wind dies down and the trees come to rest (${lookup})`, async ({ page }) => {
    await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=4&lookup=${lookup}`);
    await forest(page);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(0.02);
    await page.getByRole("button", { name: "Still" }).click();
    await expect.poll(() => sway_m(page), { timeout: 120_000 }).toBeLessThan(0.005);
  });
}

test("both places of lookup move the same forest", async ({ page }) => {
  await open(page, `${SMALL}&speed=12&gust=0&lookup=server`);
  await forest(page);
  await expect.poll(() => page.evaluate(() => window.galewood!.connection.state)).toBe("live");
  await expect.poll(() => sway_m(page)).toBeGreaterThan(0.02);
  const lean = await page.evaluate(() => window.galewood!.crownDisplacement_m);
  // Towards the wind's heading of 30 degrees.
  expect(lean[0] * Math.cos(Math.PI / 6) + lean[2] * Math.sin(Math.PI / 6)).toBeGreaterThan(0.01);
});

test.describe("on a phone", () => {
  test.use({ viewport: { width: 390, height: 700 } });

  test("everything is in reach", async ({ page }) => {
    await open(page, "quality=low&trees=2&speed=5");
    await forest(page);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(wide).toBeLessThanOrEqual(390);
    for (const name of ["Still", "Storm", "Settings", "Upload a tree…"]) {
      const box = await page.getByRole("button", { name }).boundingBox();
      expect(box && box.x >= 0 && box.x + box.width <= 390 && box.height >= 40).toBe(true);
    }
    await page.getByRole("button", { name: "Settings" }).click();
    await expect(page.getByLabel("Mean speed (m/s)").first()).toBeVisible();
  });
});
