/** The pieces of an upload are listed with what they are; choices change the import. */
import AxeBuilder from "@axe-core/playwright";
import { branchedTree } from "../branchedTree";
import { expect, open, SMALL, test } from "../forest";

test.use({ deviceScaleFactor: 0.5 });

const GROUND = ["-4 -0.01 -4", "-4 -0.01 4", "4 -0.01 4", "4 -0.01 -4"].map((at) => `v ${at}`).join("\n");

test("pieces can be chosen as wood, leaves or left out, and restored", async ({ page }) => {
  page.setDefaultTimeout(2 * 60_000);
  await page.setViewportSize({ width: 900, height: 600 });
  await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=5`);
  const buffer = Buffer.from(`${branchedTree()}\no lawn\n${GROUND}\nf -4 -3 -2 -1\n`);
  await page.setInputFiles("#file", { name: "lawn-tree.obj", mimeType: "model/obj", buffer });
  const dialog = page.getByRole("dialog", { name: /lawn-tree/i });
  const list = dialog.getByRole("group", { name: "Detected pieces" });
  const ground = list.getByRole("combobox", { name: /Ground/ });
  await expect(ground).toHaveValue("other");
  await expect(dialog.getByText(/Left out, because it is not the tree: ground/)).toBeVisible();
  await expect(list.getByRole("button", { name: "Reset to detected" })).toHaveCount(0);

  const { violations } = await new AxeBuilder({ page }).include("dialog.own-tree").analyze();
  expect(violations).toEqual([]);

  const imported = () => page.waitForResponse((answer) => answer.request().method() === "PATCH" && answer.ok());
  const [answer] = await Promise.all([imported(), ground.selectOption("Leaves")]);
  const { report } = (await answer.json()) as { report: { parts: { kind: string; faces: number }[] } };
  expect(report.parts.filter(({ kind }) => kind === "leaves").map(({ faces }) => faces)).toEqual([2]);
  await expect(list.getByRole("combobox", { name: /Lawn/ })).toHaveValue("leaves");
  await Promise.all([imported(), list.getByRole("button", { name: "Reset to detected" }).click()]);
  await expect(ground).toHaveValue("other");
  await dialog.getByRole("button", { name: "Discard" }).click();
  await expect(dialog).toHaveCount(0);
});

test.describe("painting", () => {
  // What is under the brush is read from a drawn picture.
  test.use({ drawn: "always" });

  test("pieces are painted in the picture, undone and applied", { tag: "@long" }, async ({ page }) => {
    page.setDefaultTimeout(2 * 60_000);
    await page.setViewportSize({ width: 900, height: 600 });
    await open(page, SMALL);
    const buffer = Buffer.from(branchedTree());
    await page.setInputFiles("#file", { name: "painted-tree.obj", mimeType: "model/obj", buffer });
    const dialog = page.getByRole("dialog", { name: /painted-tree/i });
    await dialog.getByRole("button", { name: "Paint pieces" }).click();
    const bar = dialog.locator(".own-tree-paint");
    await expect(bar.getByRole("status")).toContainText("Drag over the tree");
    const { violations } = await new AxeBuilder({ page }).include("dialog.own-tree").analyze();
    expect(violations).toEqual([]);

    await bar.getByRole("radio", { name: "Leaves" }).check();
    const box = (await dialog.locator("canvas").boundingBox())!;
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    // across the whole crown, through trunk and branches
    await page.mouse.move(x - box.width / 4, y - box.height / 8);
    await page.mouse.down();
    await page.mouse.move(x + box.width / 4, y - box.height / 8, { steps: 3 });
    await page.mouse.up();
    await expect(bar.getByRole("status")).toHaveText(/^\d+ pieces? changed/);
    await page.keyboard.press("Control+z");
    await expect(bar.getByRole("status")).toHaveText(/^Drag/);
    await expect(bar.getByRole("button", { name: "Apply" })).toBeDisabled();
    await bar.getByRole("button", { name: "Redo" }).click();
    const answer = page.waitForResponse((one) => one.request().method() === "PATCH" && one.ok());
    await bar.getByRole("button", { name: "Apply" }).click();
    const { report } = (await (await answer).json()) as { report: { pieces: { ranges?: string[]; kind: string }[] } };
    const painted = report.pieces.filter(({ ranges }) => ranges !== undefined);
    expect(painted.length).toBeGreaterThan(0);
    expect(new Set(painted.map(({ kind }) => kind))).toEqual(new Set(["leaves"]));
    await expect(dialog.getByText("painted", { exact: false }).first()).toBeVisible();
    await dialog.getByRole("button", { name: "Discard" }).click();
    await expect(dialog).toHaveCount(0);
  });
});

test("all trees of a file become uploads, and can be cancelled", { tag: "@long" }, async ({ page, request }) => {
  page.setDefaultTimeout(2 * 60_000);
  await page.setViewportSize({ width: 900, height: 600 });
  await open(page, SMALL.replace("panel=0", "panel=1")); // the cards are in the panel
  const buffer = Buffer.from(twoTrees());
  await page.setInputFiles("#file", { name: "garden.obj", mimeType: "model/obj", buffer });
  const dialog = page.getByRole("dialog", { name: /garden/i });
  // Trees move at once: the start of the second one is held back, so that it can be cancelled before it moves.
  let goOn = () => {};
  const cancelled = new Promise<void>((resolve) => {
    goOn = resolve;
  });
  let starts = 0;
  await page.route("**/api/jobs", async (route) => {
    if (++starts === 2) await cancelled;
    await route.continue();
  });
  const copied = page.waitForResponse((one) => one.url().endsWith("/copies"));
  await dialog.getByRole("button", { name: "Import all 2 trees" }).click();
  await expect(dialog.getByRole("listitem")).toHaveCount(2);
  expect((await copied).status()).toBe(201);
  const get = async (path: string) => (await request.get(`${process.env.BASE_URL}/api/${path}`)).json();
  const uploads = async () => {
    const { trees } = (await get("trees")) as { trees: { name: string; job_id: string }[] };
    return trees.filter(({ name }) => name.startsWith("garden ")).sort((a, b) => a.name.localeCompare(b.name));
  };
  const states = async () => Promise.all((await uploads()).map(async ({ job_id }) => (await get(`jobs/${job_id}`)).state));
  const names = async () => (await uploads()).map(({ name }) => name);
  expect(await names()).toEqual(["garden 1", "garden 2"]);
  await expect(dialog.getByRole("listitem").first()).toContainText("It moves");
  await dialog.getByRole("button", { name: "Cancel all" }).click();
  goOn();
  await expect(dialog).toHaveCount(0);
  await expect.poll(names).toEqual(["garden 1"]);
  // The first one moves already: only its computation ends.
  await page.locator("#progress").getByRole("button", { name: /^Cancel: garden 1/i }).click();
  await expect.poll(states).toEqual(["cancelled"]);
});

/** The branched tree, and a copy of it 9 m away. */
function twoTrees(): string {
  const lines = branchedTree().trim().split("\n");
  const count = lines.filter((line) => line.startsWith("v ")).length;
  const copy = lines.map((line) => {
    const [kind, ...values] = line.split(" ");
    if (kind === "v") return `v ${Number(values[0]) + 9} ${values[1]} ${values[2]}`;
    return kind === "f" ? `f ${values.map((value) => Number(value) + count).join(" ")}` : line;
  });
  return `${[...lines, ...copy].join("\n")}\n`;
}
