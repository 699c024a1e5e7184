/** Screenshots of the user interface: page, selected tree, comparison, upload, tree physics, phone. */
import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import type { Browser, Page } from "@playwright/test";
import {
  drawn,
  forest,
  LARGE_VIEWPORT,
  LOOK_QUERY,
  PATIENCE_MS,
  resize,
  save,
  steps,
  TINY_VIEWPORT,
} from "./page";

const OWN_TREE = resolve(import.meta.dirname, "../../../assets/species/apricot.glb");

async function whole(page: Page): Promise<void> {
  await page.setViewportSize(LARGE_VIEWPORT);
  await forest(page, `${LOOK_QUERY}&speed=7&time=0.7`);
  await drawn(page);
  await save(page, "page");
}

/** A nearby tree of the initial view, selected. */
async function picked(page: Page): Promise<void> {
  await page.setViewportSize({ width: 480, height: 270 });
  await forest(page, `${LOOK_QUERY}&speed=11&time=0.62&panel=1`);
  await steps(page, 40);
  const found = await page.evaluate(() => {
    for (let x = 0.42 * innerWidth; x < 0.95 * innerWidth; x += 6) {
      const tree = window.galewood?.pick(x, 0.45 * innerHeight);
      if (tree && tree.distance_m < 45) return tree;
    }
    return null;
  });
  if (!found) throw new Error("no tree in view");
  await page.evaluate(({ position: { x, z }, height_m }) => {
    const [far_m, above] = [1.5 * height_m, 0.5 * height_m];
    window.galewood?.look({ x: x - 0.4 * far_m, above, z: z + far_m }, { x, above, z });
  }, found);
  await page.waitForFunction(() => document.querySelectorAll(".picked img").length > 0);
  await steps(page, 60, 0.1); // fills the plot of the tip displacement
  await resize(page, LARGE_VIEWPORT);
  await drawn(page);
  await save(page, "inspect");
}

/** Takes minutes, because the server computes the reference solution first. */
async function compared(page: Page): Promise<void> {
  await page.setViewportSize(LARGE_VIEWPORT);
  await forest(page, "quality=low&trees=6&speed=12&time=0.6");
  await page.locator("#tools").getByRole("button", { name: "Check accuracy" }).click();
  await page.waitForFunction(() =>
    document.querySelector(".compare-verdict")?.textContent?.includes("% of tree height"),
  );
  await page.waitForTimeout(8000);
  await save(page, "compare");
  await page.keyboard.press("Escape");
}

/** Uploads a built-in tree with one byte changed, so that the server does not recognize it. */
async function uploaded(page: Page): Promise<void> {
  await page.setViewportSize(LARGE_VIEWPORT);
  await forest(page, "quality=low&trees=6&speed=5&time=0.6");
  const buffer = readFileSync(OWN_TREE);
  const at = buffer.indexOf('"generator":"') + 13;
  if (at > 12) buffer.write("G", at);
  await page.setInputFiles("#file", { name: "our-apricot.glb", mimeType: "model/gltf-binary", buffer });
  const dialog = page.locator("dialog.own-tree");
  await dialog.getByLabel("Height (m)").waitFor();
  await page.waitForTimeout(6000);
  await save(page, "upload");
  await dialog.getByRole("button", { name: "Discard" }).click();
  await dialog.waitFor({ state: "detached" });
}

async function known(page: Page): Promise<void> {
  await page.setViewportSize(LARGE_VIEWPORT);
  await forest(page, "quality=low&trees=6&speed=5&time=0.6");
  await page.locator("#tools").getByRole("button", { name: "Tree physics" }).click();
  await save(page, "trees");
}

async function phone(browser: Browser): Promise<void> {
  const page = await browser.newPage({
    viewport: TINY_VIEWPORT,
    deviceScaleFactor: 1.5,
    hasTouch: true,
    isMobile: true,
  });
  page.setDefaultTimeout(PATIENCE_MS);
  await page.setViewportSize({ width: 390, height: 780 });
  await forest(page, "quality=medium&trees=120&speed=7&time=0.7");
  await drawn(page);
  await save(page, "phone");
  await page.close();
}

export const PANELS: Readonly<Record<string, (page: Page, browser: Browser) => Promise<void>>> = {
  page: whole,
  inspect: picked,
  compare: compared,
  upload: uploaded,
  trees: known,
  phone: (_, browser) => phone(browser),
};
