/** Files as web sites ship them, dropped on the page, become trees that move. */
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import type { Page } from "@playwright/test";
import { expect, forest, open, SMALL, test } from "../forest";

const REPOSITORY = resolve(__dirname, "../../..");
const folder = mkdtempSync(join(tmpdir(), "galewood-formats-"));

test.use({ deviceScaleFactor: 0.5 });

test.beforeAll(() => {
  const own = join(REPOSITORY, ".venv/bin/python");
  const python = existsSync(own) ? own : "python3";
  execFileSync(python, ["-m", "tests.e2e.uploads.write_formats", folder], { cwd: REPOSITORY });
});

test.afterAll(() => rmSync(folder, { recursive: true, force: true }));

/** Drops a file on the page, as from the desktop. */
async function drop(page: Page, name: string): Promise<void> {
  const content = readFileSync(join(folder, name)).toString("base64");
  await page.evaluate(
    ([as, base64]) => {
      const bytes = Uint8Array.from(atob(base64), (char) => char.charCodeAt(0));
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([bytes], as));
      dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    },
    [name, content],
  );
}

interface Uploaded {
  id: string;
  job_id: string | null;
  height_m: number;
  report: { file: { format: string }; parts: { kind: string }[]; warnings: string[] };
}

/** Picks a tree that is near the middle of the window: its slender stem need not cover the very middle. */
const picks = (page: Page, id: string) =>
  page.evaluate((tree) => {
    for (let k = 0; k < 400; k++) {
      const left_px = innerWidth * (0.3 + 0.02 * (k % 20));
      const top_px = innerHeight * (0.3 + 0.02 * Math.floor(k / 20));
      if (window.galewood!.pick(left_px, top_px)?.treeId === tree) return true;
    }
    return false;
  }, id);

/** Ends the computation of later tables: the first motion is enough. */
async function cancel(page: Page, id: string): Promise<void> {
  const { job_id } = (await (await page.request.get(`${process.env.BASE_URL}/api/trees/${id}`)).json()) as Uploaded;
  if (job_id) await page.request.post(`${process.env.BASE_URL}/api/jobs/${job_id}/cancel`);
}

for (const { name, format, leaves } of [
  { name: "draco.glb", format: "glb", leaves: true },
  { name: "skinned.glb", format: "glb", leaves: false },
  { name: "tree.zip", format: "obj", leaves: true },
  { name: "scan.ply", format: "ply", leaves: false },
]) {
  test(`${name}, dropped on the page, becomes a tree that moves`, { tag: "@long" }, async ({ page }) => {
    test.setTimeout(12 * 60_000);
    page.setDefaultTimeout(3 * 60_000);
    await page.setViewportSize({ width: 640, height: 480 });
    await open(page, `${SMALL.replace("panel=0", "panel=1")}&speed=14`);
    await forest(page);
    const answered = page.waitForResponse(
      (answer) => answer.request().method() === "POST" && answer.url().endsWith("/api/trees"),
    );
    await drop(page, name);
    const { id, height_m, report } = (await (await answered).json()) as Uploaded;
    expect(report.file.format).toBe(format);
    expect(height_m).toBeCloseTo(4.9, 0); // upright, in metres
    expect(report.parts.map(({ kind }) => kind).includes("leaves")).toBe(leaves);
    expect(report.warnings.filter((words) => /texture|material|skin/.test(words))).toEqual([]);
    const dialog = page.getByRole("dialog");
    await dialog.getByRole("button", { name: "Add to the forest" }).click();
    await page.setViewportSize({ width: 64, height: 36 }); // leaves the processor to the computation
    await expect(dialog).toBeHidden({ timeout: 10 * 60_000 }); // it closes when the tree moves
    await page.setViewportSize({ width: 320, height: 180 });
    expect(await page.evaluate((tree) => window.galewood!.planted(tree), id)).toBe(1);
    await expect.poll(() => picks(page, id)).toBe(true);
    await expect.poll(() => page.evaluate(() => window.galewood!.picked!.tip_m)).toBeGreaterThan(1e-3);
    await cancel(page, id);
  });
}
