/** Files that are no trees: an inventory plants the forest, a measurement becomes the wind. */
import AxeBuilder from "@axe-core/playwright";
import type { Page } from "@playwright/test";
import { expect, forest, open, SMALL, test } from "../forest";

test.use({ viewport: { width: 800, height: 600 }, deviceScaleFactor: 0.4 });

/** Drops a text file on the page, as from the desktop. */
const drop = (page: Page, name: string, text: string) =>
  page.evaluate(
    ([as, content]) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([content], as));
      dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    },
    [name, text],
  );

/** The dialog with a report, which must be accessible. */
async function reportOf(page: Page, name: string) {
  const report = page.getByRole("dialog", { name });
  await report.waitFor();
  const { violations } = await new AxeBuilder({ page }).include("dialog.report-dialog").analyze();
  expect(violations).toEqual([]);
  return report;
}

const moving = (page: Page) => page.evaluate(() => window.galewood?.trees.moving ?? 0);

const stem = (east_m: number, north_m: number, species: string, builtin: string, height_m: number) => ({
  east_m,
  north_m,
  species,
  builtin,
  height_m,
  slender: false,
});
const STEMS = [
  stem(-15, -20, "Bergahorn", "maple", 12),
  stem(15, -20, "Populus nigra", "poplar", 16),
  stem(15, 20, "Marille", "apricot", 5),
  stem(-10, 15, "Acer", "maple", 9),
];

test("an inventory plants its stems, from an address and from a dropped file", async ({ page, quiet }) => {
  await page.route("**/api/inventory", (route) => route.fulfill({ json: { version: 1, stems: STEMS } }));
  await open(page, `${SMALL}&inventory=api/inventory`);
  await expect.poll(() => moving(page)).toBe(4);
  // the camera shows the plot from the south
  const [, , z] = await page.evaluate(() => window.galewood!.eye);
  expect(z).toBeGreaterThan(-26 + 20);
  expect(page.url()).toContain("inventory=");

  await drop(page, "three.geojson", JSON.stringify({
    type: "FeatureCollection",
    features: [[8.4, 49], [8.4002, 49], [8.4001, 49.0001]].map((coordinates, k) => ({
      type: "Feature",
      geometry: { type: "Point", coordinates },
      properties: { baumart: k === 0 ? "Winterlinde" : "Pappel", h: 11 + k },
    })),
  }));
  const report = await reportOf(page, "Forest from an inventory");
  await expect(report).toContainText("3 of 3 rows");
  await expect(report).toContainText("Winterlinde is shown as beech");
  await report.getByRole("button", { name: "Close" }).click();
  await expect.poll(() => moving(page)).toBe(3);

  // without a service the page plants what was converted before, and says so of anything else
  await page.route("**/api/convert*", (route) => route.fulfill({ status: 404, body: "no such file" }));
  await drop(page, "two.csv", "x,y,height\n0,0,9\n5,5,9\n");
  await expect(page.getByText("Convert the file with `galewood convert`")).toBeVisible();
  expect(quiet.splice(0)).toEqual([expect.stringContaining("status of 404")]); // Chromium says so too
  await drop(page, "two.forest.json", JSON.stringify({ version: 1, stems: STEMS.slice(0, 2) }));
  await (await reportOf(page, "Forest from an inventory")).getByRole("button", { name: "Close" }).click();
  await expect.poll(() => moving(page)).toBe(2);
});

test("a dropped measurement becomes the wind, and trees bend with it", { tag: "@long" }, async ({ page, quiet }) => {
  await open(page, `${SMALL}&trees=2&speed=0`);
  await forest(page);
  const lines = Array.from({ length: 40 }, (_, k) => `${k};${9 + (k % 3)},5;270`);
  await drop(page, "mast.csv", `Zeit (s);Windgeschwindigkeit (m/s);Windrichtung\n${lines.join("\n")}\n`);
  const report = await reportOf(page, "Measured wind");
  await expect(report).toContainText("10.5 m/s from 270°");
  await report.getByRole("button", { name: "Close" }).click();
  const wind = await page.evaluate(() => window.galewood!.wind);
  expect(wind).toMatchObject({ model: "recorded", recording: { interval_s: 1 } });
  // a westerly bends the trees to the east
  await expect
    .poll(() => page.evaluate(() => {
      const [x, , z] = window.galewood!.crownDisplacement_m;
      return x / Math.max(1e-3, Math.hypot(x, z));
    }))
    .toBeGreaterThan(0.9);

  await drop(page, "broken.csv", `time,speed,direction\n0,fast,270\n`);
  await expect(page.getByText("Line 2, column 'speed': 'fast' is not a number.")).toBeVisible();
  expect(quiet.splice(0)).toEqual([expect.stringContaining("status of 422")]);
});
