/** Renders a short film frame by frame on the page's clock; scripts/film.py combines the frames into one file. */
import { execFileSync } from "node:child_process";
import { mkdirSync, rmSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import type { Page } from "@playwright/test";
import { dress, forest, frame, LOOK_QUERY, PICTURES_FOLDER, resize, steps, TINY_VIEWPORT } from "./page";
import { SHOTS } from "./shots";

const FILM_SIZE = { width: 576, height: 324 };
const FRAME_RATE_HZ = 12;
const FILM_S = 3;
/** Extra frames after the end that are faded into the beginning. */
const FADED_FRAMES = 6;
const REPOSITORY = resolve(import.meta.dirname, "../../..");

/** Advances the wind without drawing, then renders every frame. */
export async function film(page: Page): Promise<void> {
  const folder = resolve(REPOSITORY, "build/film");
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  await page.setViewportSize(TINY_VIEWPORT);
  await forest(page, `${LOOK_QUERY}&panel=0`, false);
  await dress(page, SHOTS.storm);
  await steps(page, 280, 0.05);
  await resize(page, FILM_SIZE);
  for (let k = 0; k < FRAME_RATE_HZ * FILM_S + FADED_FRAMES; k++) {
    const bytes = await frame(page, 1 / FRAME_RATE_HZ, "image/png");
    writeFileSync(`${folder}/${String(k).padStart(3, "0")}.png`, bytes);
  }
  const python = resolve(REPOSITORY, ".venv/bin/python");
  const out = `${PICTURES_FOLDER}/storm.webp`;
  execFileSync(python, [
    resolve(REPOSITORY, "scripts/film.py"),
    folder,
    out,
    String(FRAME_RATE_HZ),
    String(FADED_FRAMES),
  ]);
  console.log("storm.webp");
}
