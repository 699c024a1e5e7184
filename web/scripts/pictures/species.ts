/** Every built-in species, grown in the open, in four seasons side by side. */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import type { Page } from "@playwright/test";
import { dress, forest, frame, PICTURES_FOLDER, resize, steps, TINY_VIEWPORT } from "./page";

const SPECIES_FILE = resolve(import.meta.dirname, "../../../assets/species/species.json");
const SEASONS = ["spring", "summer", "autumn", "winter"] as const;
const SEASON_SIZE = { width: 300, height: 380 };
const MORNING_DAYTIME = 0.4;
const PICTURE_QUALITY = 0.82;
/** Distance of the eye and height of the middle of the picture, relative to the height of the tree. */
const EYE_SHARE = 1.1;
const MIDDLE_SHARE = 0.47;

/** The built-in species. */
export const SPECIES_NAMES: readonly string[] = (
  JSON.parse(readFileSync(SPECIES_FILE, "utf8")) as { id: string; form: string }[]
).flatMap(({ id, form }) => (form === "open" ? [id] : []));

/** The query of a forest of one species. */
const mixOf = (name: string) => SPECIES_NAMES.map((other) => `${other}:${other === name ? 1 : 0}`).join(",");

/** Joins pictures of one size side by side, in the page. */
async function joined(page: Page, pictures: readonly Buffer[]): Promise<Buffer> {
  const url = await page.evaluate(
    async ({ sources, width, height, quality }) => {
      const canvas = new OffscreenCanvas(width * sources.length, height);
      const context = canvas.getContext("2d");
      for (const [k, source] of sources.entries()) {
        context?.drawImage(await createImageBitmap(await (await fetch(source)).blob()), k * width, 0);
      }
      const blob = await canvas.convertToBlob({ type: "image/jpeg", quality });
      return new Promise<string>((done) => {
        const reader = new FileReader();
        reader.onload = () => done(String(reader.result));
        reader.readAsDataURL(blob);
      });
    },
    {
      sources: pictures.map((bytes) => `data:image/png;base64,${bytes.toString("base64")}`),
      ...SEASON_SIZE,
      quality: PICTURE_QUALITY,
    },
  );
  return Buffer.from(url.slice(url.indexOf(",") + 1), "base64");
}

/** The position and height of the only tree. */
async function onlyTree(page: Page): Promise<{ x: number; z: number; height_m: number }> {
  const found = await page.evaluate(() => {
    window.galewood?.look({ x: 0, above: 60, z: 0 }, { x: 0, above: 0, z: -26 });
    for (let y = 1; y < innerHeight; y++) {
      for (let x = 1; x < innerWidth; x++) {
        const tree = window.galewood?.pick(x, y);
        if (tree) return { x: tree.position.x, z: tree.position.z, height_m: tree.height_m };
      }
    }
    return null;
  });
  if (!found) throw new Error("the tree is not in view");
  await page.evaluate(() => window.galewood?.pick(0, 0)); // the sky: nothing is selected
  return found;
}

/** Takes the pictures of the species that are wanted into the folder `species`. */
export async function species(page: Page, names: readonly string[]): Promise<void> {
  mkdirSync(`${PICTURES_FOLDER}/species`, { recursive: true });
  for (const name of names) {
    await page.setViewportSize(TINY_VIEWPORT);
    await forest(page, `quality=high&trees=1&mix=${mixOf(name)}&form=open&speed=3&background=0&panel=0`);
    const { x, z, height_m } = await onlyTree(page);
    const above = MIDDLE_SHARE * height_m;
    const eye = { x: x - 0.3 * height_m, above, z: z + EYE_SHARE * height_m };
    const pictures: Buffer[] = [];
    for (const season of SEASONS) {
      await resize(page, TINY_VIEWPORT);
      await dress(page, { season, daytime: MORNING_DAYTIME, eye, at: { x, above, z }, after_s: 0 });
      await steps(page, 10);
      await resize(page, SEASON_SIZE);
      pictures.push(await frame(page, 0, "image/png"));
    }
    writeFileSync(`${PICTURES_FOLDER}/species/${name}.jpg`, await joined(page, pictures));
    console.log(`species/${name}.jpg`);
  }
}
