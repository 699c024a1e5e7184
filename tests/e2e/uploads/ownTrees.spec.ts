/** Trees that the server grows for the stems of an inventory, and for the generated forest. */
import type { Page } from "@playwright/test";
import { expect, open, SMALL, test, visitor } from "../forest";

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

/** Chromium reports the refusal to end a job, or to delete its tree, that has ended before the request arrived. */
const ENDED_BY_ITSELF = /status of 40[49].*\/api\/(jobs|trees)\//;

const grownTrees = async (page: Page) =>
  ((await (await page.request.get(`${process.env.BASE_URL}/api/trees`)).json()) as Listed).trees.filter(({ grown }) => grown);
const planted = (page: Page, id: string) => page.evaluate((tree) => window.galewood?.planted(tree) ?? 0, id);

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
  await expect(card).toContainText("3 trees take 27 s of its processors");
  await card.getByRole("button", { name: "Grow own trees" }).click();
  await expect(card).toContainText("3 trees of their own stand for 4 of 4 stems.", { timeout: 300_000 });
  const grown = await grownTrees(page);
  const names = grown.map(({ name }) => name).sort();
  expect(names).toEqual(expect.arrayContaining(["poplar-1", "poplar-2", "poplar-forest-1"]));
  await expect
    .poll(async () => Promise.all(grown.map(({ id }) => planted(page, id))))
    .toEqual(expect.arrayContaining([1, 2]));
  const counts = await Promise.all(grown.map(({ id }) => planted(page, id)));
  expect(counts.reduce((sum, count) => sum + count, 0)).toBe(4);
  await expect.poll(() => page.evaluate(() => window.galewood!.trees.moving)).toBe(4);
  expect(await planted(page, "poplar")).toBe(0);

  await card.getByRole("button", { name: "Use the built-in trees" }).click();
  await expect.poll(() => planted(page, "poplar")).toBe(4);

  // the same trees again: they are there
  await card.getByRole("button", { name: "Grow own trees" }).click();
  await expect(card).toContainText("3 trees of their own stand for 4 of 4 stems.");
  expect(await grownTrees(page)).toHaveLength(grown.length);
  expect(quiet.splice(0).filter((line) => !ENDED_BY_ITSELF.test(line))).toEqual([]);
});

test("a server that cannot grow trees says why", async ({ page, quiet }) => {
  const problem = { title: "This server cannot grow trees", hint: "Install Node 20 or newer.", status: 503 };
  await page.route("**/api/inventory", (route) => route.fulfill({ json: { version: 1, stems: STEMS } }));
  await page.route("**/api/individuals", (route) => route.fulfill({ status: 503, json: problem }));
  await open(page, `${SHOWN}&inventory=api/inventory`);
  const card = page.getByRole("article", { name: "Forest from an inventory" });
  await card.getByRole("button", { name: "Grow own trees" }).click();
  await expect(card.getByText("Install Node 20 or newer.")).toBeVisible();
  await expect(card.getByRole("button", { name: "Try again" })).toBeVisible();
  await card.getByRole("button", { name: "Use the built-in trees" }).click();
  await expect(card.getByRole("button", { name: "Grow own trees" })).toBeVisible();
  expect(quiet.splice(0)).toEqual([expect.stringContaining("status of 503")]);
});

test("a link has trees grown for the generated forest, and finds them the next time", async ({ page, browser, quiet }) => {
  const own = `${SHOWN.replace("trees=6", "trees=40")}&forest=${1000 + Math.floor(8000 * Math.random())}`;
  await open(page, `${own}&own=4`);
  await expect.poll(() => page.evaluate(() => window.galewood?.trees.moving ?? 0)).toBe(40);
  const card = page.getByRole("article", { name: "Own trees" });
  const settings = page.locator(".own-trees-state");

  // cancelled: the forest stays as it is, and nothing stays on the server
  await card.getByRole("button", { name: "Cancel" }).click();
  await expect(card).toBeHidden();
  await expect.poll(async () => (await grownTrees(page)).filter(({ state }) => state !== "ready")).toEqual([]);
  expect(await planted(page, "poplar")).toBe(40);
  await expect.poll(() => new URL(page.url()).searchParams.has("own")).toBe(false);

  await page.getByRole("button", { name: "Settings" }).click();
  await page.locator("#panel").getByLabel("Own trees", { exact: true }).fill("2");
  await page.keyboard.press("Enter");
  await expect(settings).toContainText("2 trees of their own stand for 40 of 40 trees.", { timeout: 300_000 });
  expect(new URL(page.url()).searchParams.get("own")).toBe("2");
  await expect.poll(() => planted(page, "poplar")).toBe(0);
  // one that was there before the others were cancelled may be among them
  const all = await grownTrees(page);
  const stands = await Promise.all(all.map(({ id }) => planted(page, id)));
  const grown = all.filter((_, k) => stands[k] > 0);
  const counts = stands.filter((count) => count > 0);
  expect(grown.map(({ state }) => state)).toEqual(["ready", "ready"]);
  expect(counts[0] + counts[1]).toBe(40);
  await expect.poll(() => page.evaluate(() => window.galewood!.trees.moving)).toBe(40);

  // the same link in another visit
  const asked: string[] = [];
  page.on("request", (request) => asked.push(`${request.method()} ${new URL(request.url()).pathname}`));
  await page.reload();
  await expect.poll(async () => Promise.all(grown.map(({ id }) => planted(page, id)))).toEqual(counts);
  expect(asked).not.toContain("POST /api/individuals");
  expect(await grownTrees(page)).toHaveLength(all.length);

  // shared: who joins with other settings has the same trees
  const share = `share=own-${Date.now()}`;
  await open(page, `${new URL(page.url()).search.slice(1)}&${share}`);
  await expect.poll(async () => Promise.all(grown.map(({ id }) => planted(page, id)))).toEqual(counts);
  const other = await visitor(browser);
  await open(other, `${SMALL}&${share}`);
  await expect.poll(async () => Promise.all(grown.map(({ id }) => planted(other, id)))).toEqual(counts);
  expect(new URL(other.url()).searchParams.get("own")).toBe("2");
  await other.close();
  expect(quiet.splice(0).filter((line) => !ENDED_BY_ITSELF.test(line))).toEqual([]);
});
