import { expect, forest, frames, open, SMALL, test } from "../forest";

// A wide page for the cards, at a low resolution because of software rendering.
test.use({ deviceScaleFactor: 0.5 });

test("a click selects a tree; its figures follow its motion, and the camera can follow the tree", async ({ page }) => {
  // Wide enough that the card of the selected tree does not cover the centre.
  await page.setViewportSize({ width: 760, height: 428 });
  await open(page, `${SMALL.replace("trees=6", "trees=20")}&speed=14`);
  await forest(page);
  // Find the nearest tree in the initial view, which no other hides, then move close to it.
  const found = await page.evaluate(() => {
    let nearest = null;
    for (let x = 10; x < innerWidth; x += 15) {
      const picked = window.galewood!.pick(x, innerHeight * 0.4);
      if (picked && picked.distance_m < (nearest?.distance_m ?? 40)) nearest = picked;
    }
    return nearest;
  });
  if (!found) throw new Error("no tree in view");
  await page.evaluate(({ position: { x, z }, height_m }) => {
    const above = 0.55 * height_m;
    window.galewood!.look({ x, above, z: z + 9 }, { x, above, z });
  }, found);
  await frames(page, 2);
  const canvas = page.locator("#view");
  await canvas.click({ position: { x: 380, y: 214 } });
  const picked = await page.evaluate(() => window.galewood!.picked);
  expect(picked).toMatchObject({ id: found.id, treeId: found.treeId, moves: true });
  expect(picked!.distance_m).toBeGreaterThan(1);
  expect(picked!.distance_m).toBeLessThan(12);
  await expect.poll(() => page.evaluate(() => window.galewood!.picked!.extrapolationRatio)).toBeGreaterThan(0);
  await expect.poll(() => page.evaluate(() => window.galewood!.picked!.tip_m)).toBeGreaterThan(0.02);
  // Dragging the view is not a click.
  await page.mouse.move(420, 214);
  await page.mouse.down();
  await page.mouse.move(480, 214, { steps: 3 });
  await page.mouse.up();
  expect(await page.evaluate(() => window.galewood!.picked!.id)).toBe(found.id);
  // Following moves the tree to the centre of the view.
  await page.evaluate(({ position: { x, z } }) => {
    window.galewood!.look({ x: x + 3, above: 6, z: z + 14 }, { x: x + 6, above: 4, z });
    window.galewood!.follow(true);
  }, found);
  await frames(page, 14);
  const middle = await page.evaluate(() => window.galewood!.pick(innerWidth / 2, innerHeight / 2));
  expect(middle?.id).toBe(found.id);
  await canvas.press("Escape");
  expect(await page.evaluate(() => window.galewood!.picked)).toBeNull();
});

test("the paper's state search shows the record of the selected tree", async ({ page }) => {
  await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=12&method=paper`);
  await forest(page);
  // The records arrive after the tables.
  await expect.poll(() => page.evaluate(() => window.galewood!.paperTrees)).toBeGreaterThan(0);
  const id = await page.evaluate(() => {
    for (let y = 20; y < innerHeight; y += 10)
      for (let x = 5; x < innerWidth; x += 10) {
        const picked = window.galewood!.pick(x, y);
        if (picked) return picked.id;
      }
    return null;
  });
  expect(id).not.toBeNull();
  await expect.poll(() => page.evaluate(() => window.galewood!.picked!.record ?? -1)).toBeGreaterThanOrEqual(0);
});
