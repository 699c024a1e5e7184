/**
 * Takes the pictures of docs/images from a running server: `BASE_URL=http://127.0.0.1:8000 npm run pictures [name …]`;
 * "film" is the short film, the name of a species its four seasons. Takes several minutes without a GPU (GPU=1 uses one).
 */
import { chromium } from "@playwright/test";
import { LAUNCH } from "../../tests/e2e/chromium";
import { film } from "./pictures/film";
import { forest, LOOK_QUERY, PATIENCE_MS, TINY_VIEWPORT, take } from "./pictures/page";
import { PANELS } from "./pictures/panels";
import { SHOTS } from "./pictures/shots";
import { SPECIES_NAMES, species } from "./pictures/species";

const wanted = process.argv.slice(3);
const wants = (name: string) => wanted.length === 0 || wanted.includes(name);
const args = process.env.GPU ? ["--no-sandbox"] : LAUNCH.args;
const browser = await chromium.launch({ ...LAUNCH, args });
try {
  const page = await browser.newPage({ viewport: TINY_VIEWPORT });
  page.setDefaultTimeout(PATIENCE_MS);
  const shots = Object.entries(SHOTS).filter(([name]) => wants(name));
  if (shots.length > 0) await forest(page, `${LOOK_QUERY}&speed=7&panel=0`, false);
  for (const [name, shot] of shots) await take(page, name, shot);
  for (const [name, panel] of Object.entries(PANELS)) if (wants(name)) await panel(page, browser);
  if (wants("film")) await film(page);
  await species(page, SPECIES_NAMES.filter(wants));
} finally {
  await browser.close();
}
