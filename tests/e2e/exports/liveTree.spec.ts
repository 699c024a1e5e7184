/** A live GLB in Babylon.js: drawn on the graphics card, it stands in still air and bends in the wind it is given. */
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { expect, test } from "@playwright/test";
import { build } from "esbuild";

const REPOSITORY = resolve(__dirname, "../../..");
const ORIGIN = "http://live.test";
const PAGE = `<!doctype html><title>live</title><style>body { margin: 0 }</style>
<canvas width="520" height="620"></canvas><script type="module" src="/page.js"></script>`;
const folder = mkdtempSync(join(tmpdir(), "galewood-live-"));

interface Player {
  ready?: boolean;
  play(frames: number, wind: [number, number]): number;
}

test.beforeAll(async () => {
  const table = join(REPOSITORY, "assets/species/shipped/poplar.table");
  const options = ["--to", "live", "--seconds", "1", "--out", folder, "--name", "tree"];
  execFileSync(join(REPOSITORY, ".venv/bin/galewood"), ["export", table, ...options], { stdio: "pipe" });
  const page = { entryPoints: [join(__dirname, "liveTree.js")], outfile: join(folder, "page.js") };
  await build({ ...page, bundle: true, format: "esm", logLevel: "error" });
});

test.afterAll(() => rmSync(folder, { recursive: true, force: true }));

test("Babylon.js draws a tree that bends in the wind it is given", { tag: "@long" }, async ({ page }, about) => {
  await page.setViewportSize({ width: 520, height: 620 });
  await page.route(`${ORIGIN}/**`, (route) => {
    const { pathname } = new URL(route.request().url());
    if (pathname === "/") return route.fulfill({ contentType: "text/html", body: PAGE });
    const file = join(folder, pathname);
    if (!existsSync(file)) return route.fulfill({ status: 404 });
    const script = pathname.endsWith(".js") ? { contentType: "text/javascript" } : {};
    return route.fulfill({ ...script, body: readFileSync(file) });
  });
  await page.goto(`${ORIGIN}/`);
  await page.waitForFunction(() => (window as unknown as Player).ready);
  const shown = async (frames: number, wind: [number, number], name: string) => {
    const weight = await page.evaluate(([count, air]) => (window as unknown as Player).play(count, air), [frames, wind] as const);
    const picture = await page.screenshot({ path: about.outputPath(`${name}.png`) });
    return { weight, picture };
  };
  const still = await shown(2, [0, 0], "still");
  const stillAgain = await shown(2, [0, 0], "still-again");
  const east = await shown(60, [12, 0], "east");
  const west = await shown(120, [-12, 0], "west");
  expect(still.weight).toBe(0);
  expect(stillAgain.picture.equals(still.picture)).toBe(true);
  expect(east.picture.equals(still.picture)).toBe(false);
  expect(Math.abs(east.weight)).toBeGreaterThan(0.1);
  expect(Math.sign(east.weight)).toBe(-Math.sign(west.weight));
});
