/** Whether a page shows trees that sway, by its pictures alone. */
import type { Page } from "@playwright/test";
import { PNG } from "pngjs";
import { changedPixels, expect, type Picture } from "./forest";

const shot = async (page: Page): Promise<Picture> => PNG.sync.read(await page.screenshot());

/** Number of pixels that are neither sky nor meadow nor a blank page: brown, yellow, dark. */
function treePixels({ data }: Picture): number {
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i + 2] < 0.6 * data[i] || data[i] + data[i + 1] < 120) count++;
  return count;
}

const drawn = (page: Page) => expect.poll(async () => treePixels(await shot(page))).toBeGreaterThan(500);

/** Waits until trees are drawn, and until they stand still; returns the picture. */
export async function standing(page: Page): Promise<Picture> {
  await drawn(page);
  let picture = await shot(page);
  await expect
    .poll(async () => {
      const before = picture;
      picture = await shot(page);
      return changedPixels(before, picture, 0);
    })
    .toBe(0);
  return picture;
}

/** Waits until trees are drawn, and until they have moved. The test must `use` that every frame is `drawn`. */
export async function swaying(page: Page): Promise<void> {
  await drawn(page);
  // Three times, because the first changes may be those of pictures that are still being loaded.
  for (let changes = 0; changes < 3; changes++) {
    const before = await shot(page);
    await expect.poll(async () => changedPixels(before, await shot(page), 24)).toBeGreaterThan(100);
  }
}
