/** Renders a short film frame by frame on the page's clock; scripts/film.py combines the frames into one file. */
import { execFileSync } from "node:child_process";
import { mkdirSync, rmSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import type { Page } from "@playwright/test";
import { dress, FOLDER, forest, frame, LOOK, resize, steps, TINY } from "./page";
import { SHOTS } from "./shots";

const SIZE = { width: 576, height: 324 };
const FPS = 12;
const FILM_S = 3;
/** Extra frames after the end that are faded into the beginning. */
const FADED = 6;
const REPOSITORY = resolve(import.meta.dirname, "../../..");

/** Advances the wind without drawing, then renders every frame. */
export async function film(page: Page): Promise<void> {
  const folder = resolve(REPOSITORY, "build/film");
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  await page.setViewportSize(TINY);
  await forest(page, `${LOOK}&panel=0`);
  await dress(page, SHOTS.storm);
  await steps(page, 280, 0.05);
  await resize(page, SIZE);
  for (let k = 0; k < FPS * FILM_S + FADED; k++) {
    const bytes = await frame(page, 1 / FPS, "image/png");
    writeFileSync(`${folder}/${String(k).padStart(3, "0")}.png`, bytes);
  }
  const python = resolve(REPOSITORY, ".venv/bin/python");
  const out = `${FOLDER}/storm.webp`;
  execFileSync(python, [resolve(REPOSITORY, "scripts/film.py"), folder, out, String(FPS), String(FADED)]);
  console.log("storm.webp");
}
