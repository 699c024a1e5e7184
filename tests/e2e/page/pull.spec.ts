import type { Page } from "@playwright/test";
import { elapse, expect, forest, frames, open, sway_m, test } from "../forest";

test.use({ deviceScaleFactor: 0.3, drawn: "sometimes", viewport: { width: 480, height: 300 } });

const STILL = "panel=0&quality=low&trees=2&flutter=0&background=0&speed=0&gust=0";

interface Tree {
  id: number;
  x: number;
  z: number;
  height_m: number;
}

/** Looks at the tip of the nearest tree from a few metres away, and selects the tree. */
async function lookAtTip(page: Page, away_m = 6): Promise<Tree> {
  const found = await page.evaluate(() => {
    const seen = [];
    for (let y = 20; y < innerHeight; y += 12)
      for (let x = 5; x < innerWidth; x += 12) {
        const picked = window.galewood!.pick(x, y);
        if (picked) seen.push(picked);
      }
    return seen.sort((a, b) => a.distance_m - b.distance_m)[0] ?? null;
  });
  if (!found) throw new Error("no tree in view");
  const { id, height_m, position } = found;
  const tree = { id, height_m, x: position.x, z: position.z };
  await page.evaluate(
    ({ x, z, height_m: above, away }) => window.galewood!.look({ x, above, z: z + away }, { x, above: above - 0.4, z }),
    { ...tree, away: away_m },
  );
  await frames(page, 2);
  return tree;
}

/** The highest pixel of a tree, which is selected by that. */
const topOf = (page: Page, id: number) =>
  page.evaluate((wanted) => {
    for (let y = 10; y < innerHeight - 40; y += 3)
      for (let x = 60; x < innerWidth - 60; x += 4)
        if (window.galewood!.pick(x, y)?.id === wanted) return { x, y: y + 4 };
    return null;
  }, id);

/** A point just below the top of a tree at which the cursor shows that it can be grabbed. */
async function gripOf(page: Page, id: number): Promise<{ x: number; y: number }> {
  const top = await topOf(page, id);
  if (!top) throw new Error("the tip is not in view");
  const grabs = () => page.evaluate(() => document.getElementById("view")!.style.cursor === "grab");
  // Trees are selected by their outline, but held at their wood and leaves, between which there are gaps.
  for (let y = top.y; y < top.y + 160; y += 12) {
    for (const x of [top.x, top.x - 16, top.x + 16, top.x - 32, top.x + 32]) {
      await page.mouse.move(x, y);
      await frames(page, 3);
      if (await grabs()) return { x, y };
    }
  }
  throw new Error("nothing to grab near the tip");
}

const pull = (page: Page) => page.evaluate(() => window.galewood!.pull);

/** Largest displacement of the selected tree's tip over the next two seconds of the forest's time. */
const largestTip_m = async (page: Page) => (await elapse(page, 2)).tip_m;

test("a dragged branch follows the pointer, and rings down after the release", { tag: "@long" }, async ({ page }) => {
  await open(page, STILL);
  await forest(page);
  const tree = await lookAtTip(page);
  const top = await gripOf(page, tree.id);
  const eye = await page.evaluate(() => window.galewood!.eye);
  await page.mouse.down();
  await page.mouse.move(top.x + 9, top.y, { steps: 2 });
  await page.mouse.move(top.x + 10, top.y);
  await expect.poll(async () => (await pull(page))?.force_N ?? 0).toBeGreaterThan(1);
  const start_px = (await pull(page))!.start_px;
  await expect
    .poll(async () => {
      const { point_px, hand_px } = (await pull(page))!;
      return Math.hypot(point_px.x - hand_px.x, point_px.y - hand_px.y);
    })
    .toBeLessThan(4);
  const { hand_px, moved_m, id } = (await pull(page))!;
  expect(id).toBe(tree.id);
  // The hand keeps its distance from the pointer, and the branch stays with the hand.
  expect(Math.hypot(hand_px.x - start_px.x - 10, hand_px.y - start_px.y)).toBeLessThan(1.5);
  expect(moved_m).toBeGreaterThan(0.05);
  // The drag has pulled the branch and not turned the view.
  expect(await page.evaluate(() => window.galewood!.eye)).toEqual(eye);
  const held_m = await page.evaluate(() => window.galewood!.picked!.tip_m);
  await page.mouse.up();
  expect(await pull(page)).toBeNull();
  const first_m = await largestTip_m(page);
  expect(first_m).toBeGreaterThan(0.2 * held_m);
  let last_m = first_m;
  for (let k = 0; k < 12 && last_m > 0.5 * first_m; k++) last_m = await largestTip_m(page);
  expect(last_m).toBeLessThan(0.5 * first_m);
});

test("all who share a forest see a pull, wherever their motion is computed", async ({ page, context }) => {
  const share = `pull-${Date.now()}`;
  await open(page, `${STILL}&lookup=server&share=${share}`);
  await forest(page);
  const other = await context.newPage();
  await open(other, `${STILL}&lookup=worker&share=${share}`);
  await forest(other);
  await page.bringToFront();
  const tree = await lookAtTip(page);
  expect(await topOf(page, tree.id)).not.toBeNull();
  await page.locator("#view").focus();
  await page.keyboard.press("p");
  for (let k = 0; k < 4; k++) await page.keyboard.press("ArrowRight");
  const force = (of: Page) =>
    of.evaluate(() => Math.hypot(...(window.galewood!.pulled.find(({ held }) => held)?.force_N ?? [0])));
  // Pages in the background are not drawn: let both advance in turn.
  await expect.poll(() => force(page)).toBeGreaterThan(1);
  await other.bringToFront();
  await expect.poll(() => force(other)).toBeGreaterThan(1);
  await page.bringToFront();
  await page.keyboard.press("Enter");
  await expect.poll(() => force(page)).toBe(0);
  await other.bringToFront();
  await expect.poll(() => force(other)).toBe(0);
});

test("a click on open ground sends a gust front downwind", { tag: "@long" }, async ({ page }) => {
  await open(page, `${STILL}&direction=90`);
  await forest(page);
  const tree = await lookAtTip(page);
  // From upwind: the wind blows towards +z.
  await page.evaluate(
    ({ x, z }) => window.galewood!.look({ x, above: 9, z: z - 26 }, { x, above: 0, z: z - 15 }),
    tree,
  );
  await frames(page, 2);
  expect(await sway_m(page)).toBeLessThan(0.002);
  await page.mouse.click(240, 150);
  expect(await page.evaluate(() => window.galewood!.picked)).toBeNull();
  await expect.poll(() => sway_m(page)).toBeGreaterThan(0.01);
});
