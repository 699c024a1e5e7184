/** The pieces of an upload are listed with what they are; choices change the import. */
import AxeBuilder from "@axe-core/playwright";
import { branchedTree } from "./branchedTree";
import { expect, open, SMALL, test } from "./forest";

test.use({ deviceScaleFactor: 0.5 });

const GROUND = ["-4 -0.01 -4", "-4 -0.01 4", "4 -0.01 4", "4 -0.01 -4"].map((at) => `v ${at}`).join("\n");

test("pieces can be chosen as wood, leaves or left out, and restored", async ({ page }) => {
  test.setTimeout(5 * 60_000);
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
  await expect(list.getByRole("button", { name: "All as detected" })).toHaveCount(0);

  const { violations } = await new AxeBuilder({ page }).include("dialog.own-tree").analyze();
  expect(violations).toEqual([]);

  const imported = () => page.waitForResponse((answer) => answer.request().method() === "PATCH" && answer.ok());
  const [answer] = await Promise.all([imported(), ground.selectOption("Leaves")]);
  const { report } = (await answer.json()) as { report: { parts: { kind: string; faces: number }[] } };
  expect(report.parts.filter(({ kind }) => kind === "leaves").map(({ faces }) => faces)).toEqual([2]);
  await expect(list.getByRole("combobox", { name: /Lawn/ })).toHaveValue("leaves");
  await Promise.all([imported(), list.getByRole("button", { name: "All as detected" }).click()]);
  await expect(ground).toHaveValue("other");
  await dialog.getByRole("button", { name: "Discard" }).click();
  await expect(dialog).toHaveCount(0);
});
