/** Trees that the server grows for the stems of an inventory. */
import type { Page } from "@playwright/test";
import { expect, open, SMALL, test } from "../forest";

test.use({ viewport: { width: 800, height: 600 }, deviceScaleFactor: 0.4 });

/** With the cards beside the forest. */
const SHOWN = SMALL.replace("panel=0", "panel=1");

const stem = (east_m: number, height_m: number, slender: boolean) => ({
  east_m,
  north_m: -15,
  species: "Populus nigra",
  builtin: "poplar",
  height_m,
  dbh_cm: null,
  slender,
});
const STEMS = [stem(-15, 12, false), stem(-5, 13, false), stem(5, 21, false), stem(15, 22, true)];

interface Listed {
  trees: { id: string; name: string; grown: boolean; state: string }[];
}

const grownTrees = async (page: Page) =>
  ((await (await page.request.get(`${process.env.BASE_URL}/api/trees`)).json()) as Listed).trees.filter(({ grown }) => grown);
const planted = (page: Page, id: string) => page.evaluate((tree) => window.galewood!.planted(tree), id);

test("stems get trees of their own, and their built-in ones back", async ({ page, quiet }) => {
  await page.route("**/api/inventory", (route) => route.fulfill({ json: { version: 1, stems: STEMS } }));
  await open(page, `${SHOWN}&inventory=api/inventory`);
  await expect.poll(() => page.evaluate(() => window.galewood?.trees.moving ?? 0)).toBe(4);
  const card = page.getByRole("article", { name: "Forest from an inventory" });
  const trees = card.getByLabel("Trees", { exact: true });
  await trees.fill("41");
  await expect(card).toContainText("Choose 1 to 40 trees.");

  // cancelled: nothing is planted, and nothing stays on the server
  await trees.fill("4");
  await card.getByRole("button", { name: "Grow own trees" }).click();
  await card.getByRole("button", { name: "Cancel" }).click();
  await expect(card.getByRole("button", { name: "Grow own trees" })).toBeVisible();
  await expect.poll(async () => (await grownTrees(page)).filter(({ state }) => state !== "ready")).toEqual([]);

  await trees.fill("3");
  await expect(card).toContainText("3 trees take 21 s of its processors");
  await card.getByRole("button", { name: "Grow own trees" }).click();
  await expect(card).toContainText("3 trees of their own stand for 4 of 4 stems.", { timeout: 120_000 });
  const grown = await grownTrees(page);
  const names = grown.map(({ name }) => name).sort();
  expect(names).toEqual(expect.arrayContaining(["poplar-1", "poplar-2", "poplar-forest-1"]));
  await expect
    .poll(async () => Promise.all(grown.map(({ id }) => planted(page, id))))
    .toEqual(expect.arrayContaining([1, 2]));
  const counts = await Promise.all(grown.map(({ id }) => planted(page, id)));
  expect(counts.reduce((sum, count) => sum + count, 0)).toBe(4);
  expect(await page.evaluate(() => window.galewood!.trees.moving)).toBe(4);
  expect(await planted(page, "poplar")).toBe(0);

  await card.getByRole("button", { name: "Use the built-in trees" }).click();
  await expect.poll(() => planted(page, "poplar")).toBe(4);

  // the same trees again: they are there
  await card.getByRole("button", { name: "Grow own trees" }).click();
  await expect(card).toContainText("3 trees of their own stand for 4 of 4 stems.");
  expect(await grownTrees(page)).toHaveLength(grown.length);
  expect(quiet.splice(0).filter((line) => !line.includes("409"))).toEqual([]);
});

test("a server that cannot grow trees says why", async ({ page, quiet }) => {
  const problem = { title: "This server cannot grow trees", hint: "Install Node 20 or newer.", status: 503 };
  await page.route("**/api/inventory", (route) => route.fulfill({ json: { version: 1, stems: STEMS } }));
  await page.route("**/api/individuals", (route) => route.fulfill({ status: 503, json: problem }));
  await open(page, `${SHOWN}&inventory=api/inventory`);
  const card = page.getByRole("article", { name: "Forest from an inventory" });
  await card.getByRole("button", { name: "Grow own trees" }).click();
  await expect(page.getByText("Install Node 20 or newer.")).toBeVisible();
  await expect(card.getByRole("button", { name: "Grow own trees" })).toBeVisible();
  expect(quiet.splice(0)).toEqual([expect.stringContaining("503")]);
});
