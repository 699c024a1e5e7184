import type { Page } from "@playwright/test";
import { branchedTree } from "./branchedTree";
import { expect, forest, open, SMALL, sway_m, test } from "./forest";

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
  await expect(alert).toBeEmpty();
});

/** A stem of ten cylinders, 3 m high, with a limb. */
function scan(): string {
  const rows = ["ID,parentID,startX,startY,startZ,endX,endY,endZ,radius"];
  for (let k = 0; k < 10; k++) rows.push([k, k - 1, 0, 0, 0.3 * k, 0, 0, 0.3 * (k + 1), 0.08 - 0.005 * k].join());
  rows.push("10,5,0,0,1.8,0.8,0,2.6,0.03");
  return rows.join("\n");
}

test("a scanned tree can be corrected before its motion is computed", async ({ page }) => {
  await open(page, `${panelled}&speed=5`);
  await page.setInputFiles("#file", { name: "scan.csv", mimeType: "text/csv", buffer: Buffer.from(scan()) });
  const dialog = page.getByRole("dialog", { name: /scan/i });
  await expect(dialog.getByLabel("Height (m)")).toHaveValue("3.0");
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

test("an uploaded tree joins the moving forest", async ({ page }) => {
  test.setTimeout(20 * 60_000);
  await open(page, `${panelled.replace("trees=6", "trees=12")}&speed=12`);
  await forest(page);
  const buffer = Buffer.from(branchedTree());
  await page.setInputFiles("#file", { name: "garden-tree.obj", mimeType: "model/obj", buffer });
  const dialog = page.getByRole("dialog", { name: /garden/i });
  await expect(dialog.getByLabel("Height (m)")).toHaveValue(/\d/);
  await dialog.getByRole("button", { name: "Add to the forest" }).click();
  await expect(page.getByRole("alert")).toContainText("Computing");
  await expect(page.getByRole("progressbar", { name: /garden/i })).toBeVisible();
  // Use a tiny viewport meanwhile: software rendering would slow down the computation of the table.
  await page.setViewportSize({ width: 64, height: 36 });
  await page.waitForFunction(
    () => window.galewood!.readySpecies.some((name) => /garden/i.test(name)),
    null,
    { timeout: 18 * 60_000, polling: 1000 },
  );
  await page.setViewportSize({ width: 320, height: 180 });
  await expect.poll(() => sway_m(page)).toBeGreaterThan(0.005);
  await cancelBuilds(page); // the first table is sufficient; the others would slow down the next tests
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
