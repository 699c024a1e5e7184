/** The wind risk of an inventory: computed, coloured, one stem on its card, saved; without a server it says so. */
import AxeBuilder from "@axe-core/playwright";
import type { Page } from "@playwright/test";
import { readFile } from "node:fs/promises";
import { expect, open, SMALL, test } from "../forest";

test.use({ viewport: { width: 800, height: 600 }, deviceScaleFactor: 0.4 });

const STAND = [
  "x;y;Baumart;Höhe (m);BHD (cm)",
  "0;0;Rotbuche;24;18",
  "9;0;Fagus sylvatica;;25",
  "0;9;Zitterpappel;21;40",
  "9;9;Bergahorn;18;",
].join("\n");

const drop = (page: Page, text: string) =>
  page.evaluate((content) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([content], "stand.csv"));
    dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  }, text);

const violations = async (page: Page) => (await new AxeBuilder({ page }).include("#cards").analyze()).violations;

test("the stems of a dropped inventory get their wind risk", { tag: "@long" }, async ({ page, quiet }) => {
  await open(page, SMALL.replace("panel=0", "panel=1"));
  await drop(page, STAND);
  await page.getByRole("dialog").getByRole("button", { name: "Close" }).click();
  await page.getByText("Wind risk", { exact: true }).click();
  const card = page.locator(".risk");
  const calculate = card.getByRole("button", { name: "Calculate" });

  // it can be cancelled; the answer that is held back never arrives
  await page.route("**/api/stand-risk*", () => {});
  await calculate.click();
  await expect(card.getByRole("progressbar")).toBeVisible();
  await card.getByRole("button", { name: "Cancel" }).click();
  await expect(card.getByRole("status")).toHaveText("Cancelled.");
  await page.unroute("**/api/stand-risk*");

  // the server is gone
  await page.route("**/api/stand-risk*", (route) => route.abort("connectionrefused"));
  await calculate.click();
  await expect(page.getByText("The server is not connected.")).toBeVisible();
  await page.unroute("**/api/stand-risk*");
  expect(quiet.splice(0)).toEqual([expect.stringContaining("ERR_CONNECTION_REFUSED")]);
  await page.getByRole("button", { name: "Try again" }).click();

  await expect(card.getByRole("status")).toHaveText("4 stems in a gust of 20 m/s, in leaf.");
  await card.getByLabel("Foliage").selectOption("Bare");
  await card.getByLabel("Gust, m/s").fill("25");
  await calculate.click();
  await expect(card.getByRole("status")).toHaveText("4 stems in a gust of 25 m/s, bare.");
  const legend = card.getByRole("list", { name: "Colours of the stems" });
  await expect(legend).toContainText("m/s");
  await card.getByLabel("Colour stems by").selectOption("Largest strain");
  await expect(legend).toContainText("mm/m");
  await expect(card).toContainText("no substitute for an inspection");
  expect(await violations(page)).toEqual([]);

  await card.getByText("Stems that break first").click();
  const first = card.locator(".risk-first").getByRole("button").first();
  await expect(first).toContainText("Rotbuche, line 2");
  await first.press("Enter");
  const stem = page.locator(".stem-risk");
  await expect(stem).toContainText("Wind risk: Rotbuche, line 2");
  await expect(stem).toContainText("1 of 4");
  await expect(stem).toContainText("10 to 90 %");
  await expect(stem).toContainText("Beech, forest-grown");
  await expect(stem).toContainText("no substitute for an inspection");
  expect(await violations(page)).toEqual([]);

  const saved = page.waitForEvent("download");
  await card.getByRole("button", { name: "Save as CSV" }).click();
  const file = await saved;
  expect(file.suggestedFilename()).toBe("stand-wind-risk.csv");
  expect(await readFile(await file.path(), "utf8")).toContain("critical_m_s");

  // another forest has no result
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  await expect(card).toBeHidden();
});
