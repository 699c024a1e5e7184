import type { Page } from "@playwright/test";
import { branchedTree } from "../branchedTree";
import { expect, forest, open, SMALL, test } from "../forest";

const panelled = SMALL.replace("panel=0", "panel=1");

test.use({ deviceScaleFactor: 0.5 });

const file = { name: "tree.glb", mimeType: "model/gltf-binary", buffer: Buffer.from("this is no tree") };

test("a file chosen before the script is loaded is not lost", async ({ page, quiet }) => {
  await page.setViewportSize({ width: 640, height: 480 });
  let release = () => {};
  const chosen = new Promise<void>((resolve) => {
    release = resolve;
  });
  await page.route("**/*.js", async (route) => {
    await chosen;
    await route.continue();
  });
  await page.goto(`${process.env.BASE_URL}/?${panelled}&speed=5`, { waitUntil: "commit" });
  await page.setInputFiles("#file", file);
  release();
  await expect(page.getByRole("alert").locator("strong")).not.toBeEmpty();
  expect(quiet.splice(0).length).toBeGreaterThan(0); // the browser logs the refused request
});

test("an invalid file is rejected with an explanation", async ({ page, quiet }) => {
  await page.setViewportSize({ width: 640, height: 480 });
  await open(page, `${panelled}&speed=5`);
  await page.setInputFiles("#file", file);
  const alert = page.getByRole("alert");
  await expect(alert.locator("strong")).not.toBeEmpty();
  await expect(alert.locator("p")).not.toBeEmpty();
  // The browser itself logs the refused request.
  const refusals = quiet.splice(0).filter((text) => !/the server responded with a status of 4\d\d/.test(text));
  expect(refusals).toEqual([]);
  await page.getByRole("button", { name: "Dismiss" }).click();
  await expect(alert.locator("strong")).toHaveCount(0);
});

/** A stem of ten cylinders, 3 m high, with a limb. */
function scan(): string {
  const rows = ["ID,parentID,startX,startY,startZ,endX,endY,endZ,radius"];
  for (let k = 0; k < 10; k++) rows.push([k, k - 1, 0, 0, 0.3 * k, 0, 0, 0.3 * (k + 1), 0.08 - 0.005 * k].join());
  rows.push("10,5,0,0,1.8,0.8,0,2.6,0.03");
  return rows.join("\n");
}

test("a scanned tree can be corrected before its motion is computed", async ({ page, quiet }) => {
  await open(page, `${panelled}&speed=5`);
  await page.setInputFiles("#file", { name: "scan.csv", mimeType: "text/csv", buffer: Buffer.from(scan()) });
  const dialog = page.getByRole("dialog", { name: /scan/i });
  await expect(dialog.getByLabel("Height (m)")).toHaveValue("3.0");
  expect(quiet.splice(0)).toEqual([expect.stringContaining("status of 415")]); // the service found no wind and no inventory in it
  await expect(dialog.getByLabel("Trunk (cm)")).toHaveValue("12.0");
  const imported = () => page.waitForResponse((answer) => answer.request().method() === "PATCH" && answer.ok());
  const fill = (name: string, value: string) =>
    Promise.all([imported(), dialog.getByLabel(name).fill(value).then(() => dialog.getByLabel(name).press("Enter"))]);
  await fill("Trunk (cm)", "20");
  await expect(dialog.getByText(/no leaves/)).toBeVisible();
  await Promise.all([imported(), dialog.getByRole("combobox", { name: /^Leaves/ }).selectOption("None")]);
  await expect(dialog.getByText(/no leaves/)).toBeHidden();
  await expect(dialog.getByLabel("Trunk (cm)")).toHaveValue("20.0");
  await fill("Finest (mm)", "60");
  await expect(dialog.getByText(/^1 dropped/)).toBeVisible();
  await dialog.getByRole("button", { name: "Discard" }).click();
});

const garden = (comment: string) => ({
  name: "garden-tree.obj",
  mimeType: "model/obj",
  buffer: Buffer.from(`# ${comment}\n${branchedTree()}`),
});

/** Uploads a tree and starts its computation; returns the dialog and the tree's id. */
async function start(page: Page, comment: string) {
  const uploaded = page.waitForResponse((answer) => answer.request().method() === "POST" && answer.url().endsWith("/api/trees"));
  await page.setInputFiles("#file", garden(comment));
  const { id } = (await (await uploaded).json()) as { id: string };
  const dialog = page.getByRole("dialog", { name: /garden/i });
  await expect(dialog.getByLabel("Height (m)")).toHaveValue(/\d/);
  // Thick and bare: as stiff as its wood it would not seem to move, so the slider starts at the lively end.
  await expect(dialog.getByText(/would be barely visible/)).toBeVisible();
  await expect(dialog.getByRole("slider", { name: /Stiffness/ })).toHaveValue("1");
  await dialog.getByRole("button", { name: "Add to the forest" }).click();
  // In the dialog, or in the card that stays when the dialog closes, as soon as the tree moves.
  await expect(page.getByRole("progressbar", { name: /garden/i }).first()).toBeVisible();
  return { dialog, id };
}

const planted = (page: Page, id: string) => page.evaluate((tree) => window.galewood?.planted(tree) ?? -1, id);

test("an upload leads its owner to it, and only its owner", { tag: "@long" }, async ({ page, browser }) => {
  test.setTimeout(20 * 60_000);
  page.setDefaultTimeout(3 * 60_000);
  await open(page, `${panelled.replace("trees=6", "trees=12")}&speed=12`);
  await forest(page);
  const eye = await page.evaluate(() => window.galewood!.eye);
  const { dialog, id } = await start(page, "mine");
  await expect(page.getByText(/ left$|longer than expected$/).first()).toBeVisible();
  // One of its kind stands in the clearing while it is computed.
  await expect.poll(() => planted(page, id)).toBe(1);
  // Use a tiny viewport meanwhile: software rendering would slow down the computation of the table.
  await page.setViewportSize({ width: 64, height: 36 });
  await expect(dialog).toBeHidden({ timeout: 18 * 60_000 }); // it closes when the tree moves
  await page.setViewportSize({ width: 320, height: 180 });
  const picked = () => page.evaluate(() => window.galewood!.pick(innerWidth / 2, innerHeight / 2)?.treeId);
  await expect.poll(picked).toBe(id);
  const seen = await page.evaluate(() => window.galewood!.eye);
  expect(Math.hypot(...seen.map((at, axis) => at - eye[axis]))).toBeGreaterThan(3);
  await expect.poll(() => page.evaluate(() => window.galewood!.picked!.tip_m)).toBeGreaterThan(2e-3); // a tenth as much without the choice
  expect(await planted(page, id)).toBe(1);
  await cancelBuilds(page); // the first table is sufficient; the others would slow down the next tests

  await test.step("it is still planted after a reload, and the settings plant more of it", async () => {
    await open(page, `${panelled.replace("trees=6", "trees=40")}&speed=12`);
    await forest(page);
    await expect.poll(() => planted(page, id)).toBe(1);
    await page.setViewportSize({ width: 640, height: 480 });
    await page.getByRole("button", { name: "Settings" }).click();
    await page.locator("#panel").getByRole("button", { name: "Uploaded trees" }).click();
    const choice = page.locator("#panel").getByRole("combobox", { name: "Garden-tree", exact: true });
    await choice.selectOption("Among the others");
    await expect.poll(() => planted(page, id)).toBeGreaterThan(1);
    await choice.selectOption("Only this");
    await expect.poll(() => planted(page, id)).toBe(41);
    await choice.selectOption("One in the clearing");
    await expect.poll(() => planted(page, id)).toBe(1);
  });

  await test.step("another visitor has it only by a link", async () => {
    await page.evaluate(() => window.galewood!.sleep(true)); // leaves the processor to the other page
    const other = await (await browser.newContext()).newPage();
    await open(other, `${SMALL}&speed=12`);
    await forest(other);
    expect(await planted(other, id)).toBe(0);
    await open(other, `${SMALL}&speed=12&tree=${id}`);
    await forest(other);
    await expect.poll(() => planted(other, id)).toBe(1);
    await other.context().close();
  });
});

test("an upload can be cancelled while it is computed", async ({ page }) => {
  test.setTimeout(20 * 60_000);
  await open(page, `${panelled}&speed=5`);
  await forest(page);
  const { dialog, id } = await start(page, "cancelled");
  await expect(dialog).toBeHidden(); // the tree moves
  await page.setViewportSize({ width: 640, height: 480 }); // with room for the cards
  await page.locator("#progress").getByRole("button", { name: /^Cancel/ }).click();
  // It is gone unless it had begun to move; then only its computation ends.
  const active = async () => {
    const { trees } = await (await page.request.get(`${process.env.BASE_URL}/api/trees`)).json();
    const tree = trees.find((one: { id: string }) => one.id === id);
    if (!tree) return false;
    const { state } = await (await page.request.get(`${process.env.BASE_URL}/api/jobs/${tree.job_id}`)).json();
    return state === "queued" || state === "running";
  };
  await expect.poll(active).toBe(false);
  await expect(page.getByText(/^Cancelled/)).toBeVisible();
});

/** Cancels every build, also one that has only the records of the paper's method left. */
async function cancelBuilds(page: Page): Promise<void> {
  const { trees } = await (await page.request.get(`${process.env.BASE_URL}/api/trees`)).json();
  const jobs: string[] = trees.flatMap(({ job_id }: { job_id: string | null }) => job_id ?? []);
  for (const id of jobs) {
    const path = `${process.env.BASE_URL}/api/jobs/${id}`;
    const { state } = await (await page.request.get(path)).json();
    if (state === "queued" || state === "running") expect((await page.request.post(`${path}/cancel`)).ok()).toBe(true);
  }
}
