import { background, changedPixels, elapse, expect, forest, frames, open, picture, SMALL, steadyDisplacement_m, sway_m, test } from "../forest";

test.describe("pictures", () => {
  test.use({ drawn: "always" });

  test("the page shows a forest", async ({ page }) => {
    await open(page, `${SMALL}&speed=10`);
    await forest(page);
    const colours = new Set<number>();
    const { data } = await picture(page);
    for (let i = 0; i < data.length; i += 4) colours.add((data[i] >> 3) * 1024 + (data[i + 1] >> 3) * 32 + (data[i + 2] >> 3));
    expect(colours.size).toBeGreaterThan(200);
    expect(await page.evaluate(() => window.galewood!.readySpecies.length)).toBeGreaterThan(0);
  });

  test("land on which no trees are planted has its plants and shadows too", async ({ page }) => {
    await open(page, `${SMALL}&mix=poplar:0`);
    // Sky and ground take two draw calls, which is all that a page shows while trees are on their way.
    await page.waitForFunction(() => (window.galewood?.statistics.drawCalls ?? 0) > 4);
    expect(await page.evaluate(() => window.galewood!.trees)).toMatchObject({ moving: 0, still: 0 });
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
    test(`still air: no pixel changes (${lookup})`, { tag: "@long" }, async ({ page }) => {
      await open(page, `${SMALL}&speed=0&lookup=${lookup}`);
      await forest(page);
      await background(page);
      await frames(page, 4);
      const before = await picture(page);
      const time_s = await page.evaluate(() => window.galewood!.time_s);
      await page.waitForFunction((from) => window.galewood!.time_s > from + 1, time_s);
      expect(changedPixels(before, await picture(page), 0)).toBe(0);
      expect(await sway_m(page)).toBeLessThan(1e-4);
    });
  }

  test("the forest goes on beyond the simulated trees", { tag: "@long" }, async ({ page }) => {
    await open(page, SMALL.replace("background=0", "background=1"));
    await forest(page);
    await background(page);
    expect(await page.evaluate(() => window.galewood!.statistics.impostors.backgroundTrees)).toBeGreaterThan(100);
  });
});

for (const lookup of ["worker", "server"] as const) {
  test(`the wind dies down and the trees come to rest (${lookup})`, { tag: lookup === "server" ? "@long" : [] }, async ({ page }) => {
    await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=4&lookup=${lookup}`);
    await forest(page);
    await expect.poll(() => sway_m(page)).toBeGreaterThan(0.02);
    await page.getByRole("button", { name: "Still" }).click();
    await expect.poll(() => sway_m(page)).toBeLessThan(0.005);
  });
}

test("the worker and the server compute the same displacement in a steady wind", async ({ page }) => {
  const heading_rad = Math.PI / 6;
  const displacements: (readonly [number, number])[] = [];
  for (const lookup of ["worker", "server"] as const) {
    await open(page, `${SMALL}&speed=12&direction=30&gust=0&lookup=${lookup}`);
    await forest(page);
    // "idle": no connection is used, the poses come from the worker. "live": they come from the server.
    const state = lookup === "server" ? "live" : "idle";
    await expect.poll(() => page.evaluate(() => window.galewood!.connection.state)).toBe(state);
    const [x, z] = await steadyDisplacement_m(page);
    expect(await page.evaluate(() => window.galewood!.connection.state)).toBe(state);
    const along = x * Math.cos(heading_rad) + z * Math.sin(heading_rad);
    const across = z * Math.cos(heading_rad) - x * Math.sin(heading_rad);
    expect(along).toBeGreaterThan(0.02);
    expect(Math.abs(across)).toBeLessThan(0.3 * along);
    displacements.push([x, z]);
  }
  const [worker, server] = displacements;
  expect(Math.hypot(worker[0] - server[0], worker[1] - server[1])).toBeLessThan(0.1 * Math.hypot(...worker));
});

test("two workers share the trees and move all of them as one does", async ({ page }) => {
  const ends: (readonly number[])[] = [];
  for (const count of [1, 2]) {
    await open(page, `${SMALL.replace("trees=6", "trees=1500")}&speed=12&direction=30&gust=0&workers=${count}`);
    await forest(page);
    expect(page.workers().filter((worker) => worker.url().includes("forest.worker")).length).toBe(count);
    const { crowns_m } = await elapse(page, 10);
    ends.push(crowns_m[crowns_m.length - 1]);
  }
  const [one, two] = ends;
  expect(Math.hypot(...one)).toBeGreaterThan(0.02);
  expect(Math.hypot(...one.map((metres, axis) => metres - two[axis]))).toBeLessThan(0.05 * Math.hypot(...one));
});

test.describe("on a phone", () => {
  test.use({ viewport: { width: 390, height: 700 } });

  test("all controls fit on the screen", async ({ page }) => {
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
