import { branchedTree } from "./branchedTree";
import { expect, forest, open, SMALL, test } from "./forest";

const panelled = SMALL.replace("panel=0", "panel=1");

// A wide page for the dialogs; the picture behind them is drawn in fewer pixels, in software.
test.use({ deviceScaleFactor: 0.5 });

test("a tree is held against the full simulation, and the errors are told", async ({ page }) => {
  test.setTimeout(10 * 60_000);
  await page.setViewportSize({ width: 800, height: 600 });
  await open(page, `${panelled}&speed=10`);
  await forest(page);
  await page.locator("#tools").getByRole("button", { name: "Is it right?" }).click();
  const dialog = page.getByRole("dialog", { name: "Is it right?" });
  const verdict = dialog.locator(".compare-verdict");
  await expect(verdict).toContainText("% of its height", { timeout: 8 * 60_000 });
  const [sway, error] = ((await verdict.textContent()) ?? "").match(/[\d.]+(?= %)/g)!.map(Number);
  expect(sway).toBeGreaterThan(0.01);
  expect(error).toBeLessThan(0.2 * sway + 0.02);
  await expect(dialog.locator(".compare-curves canvas")).toBeVisible();
  // The paper's search is farther off, and the sentence says so.
  await dialog.getByLabel("Method").selectOption("paper");
  await expect(verdict).not.toContainText(`farther than ${error} %`);
  await page.keyboard.press("Escape");
  await expect(dialog).toBeHidden();
});

test("an upload is shown as it was understood, can be put right, and leaves no trace if it is removed", async ({
  page,
}) => {
  await open(page, `${panelled}&speed=5`);
  const buffer = Buffer.from(branchedTree());
  await page.setInputFiles("#file", { name: "shown-tree.obj", mimeType: "model/obj", buffer });
  const dialog = page.getByRole("dialog", { name: /shown/i });
  const height = dialog.getByLabel("Height, m");
  await expect(height).toHaveValue(/\d/);
  await height.fill("7.5");
  await height.press("Enter");
  await expect(dialog.getByText(/7\.5|given/).first()).toBeVisible();
  await expect(height).toHaveValue("7.5");
  await dialog.getByRole("button", { name: "Remove it" }).click();
  await expect(dialog).toHaveCount(0);
  await expect
    .poll(async () => (await (await page.request.get(`${process.env.BASE_URL}/api/trees`)).text()).includes("shown-tree"))
    .toBe(false);
});
