/** The package `galewood` in pages of strangers: its examples, each opened once. */
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { type Bundle, bundled, EXAMPLES, type Site, site, strictPage, withEsbuild, withVite, withWebpack } from "./examples";
import { expect, test } from "../forest";
import { swaying } from "../swaying";

test.use({ drawn: "always" });

let folder = "";
test.beforeAll(() => {
  folder = mkdtempSync(join(tmpdir(), "galewood-player-"));
});
test.afterAll(() => rmSync(folder, { recursive: true, force: true }));

let served: Site | null = null;
test.afterEach(() => {
  served?.close();
  served = null;
});

/** Serves a folder for the test that runs. */
async function serving(root: string, service?: string): Promise<string> {
  served = await site(root, { service });
  return served.base;
}

test("plain modules with an import map, three.js 0.187", async ({ page }) => {
  await page.goto(`${await serving(EXAMPLES)}/plain/`);
  await swaying(page);
});

for (const [name, bundle, three, release] of [
  ["Vite", withVite, "three-186", "0.186"],
  ["webpack", withWebpack, "three-185", "0.185"],
  ["esbuild", withEsbuild, "three-184", "0.184"],
] satisfies [string, Bundle, string, string][]) {
  test(`the same scene, bundled by ${name}, three.js ${release}`, { tag: "@long" }, async ({ page }) => {
    const out = join(folder, name);
    await bundle(three, out);
    await page.goto(`${await serving(out)}/`);
    await swaying(page);
  });
}

test("the custom element, whose wind can be changed", { tag: "@long" }, async ({ page }) => {
  await page.goto(`${await serving(EXAMPLES)}/element/`);
  await swaying(page);
  await expect(page.getByRole("img", { name: "Trees swaying in the wind" })).toBeVisible();
  const model = () => page.locator("galewood-forest").evaluate((one) => (one as unknown as { forest: { wind: { model: string } } }).forest.wind.model);
  expect(await model()).toBe("spectral");
  await page.locator("galewood-forest").evaluate((one) => one.setAttribute("wind", "storm-front"));
  expect(await model()).toBe("navier-stokes");
  await page.locator("galewood-forest").evaluate((one) => one.remove());
  await expect(page.locator("canvas")).toHaveCount(0);
});

test("the custom element says what is wrong with a wind, and keeps the one before", { tag: "@long" }, async ({ page, quiet }) => {
  const thrown: unknown[] = [];
  page.on("pageerror", (error) => thrown.push(error));
  await page.goto(`${await serving(EXAMPLES)}/element/`);
  await swaying(page);
  const element = page.locator("galewood-forest");
  await element.evaluate((one) => one.setAttribute("wind", '{"version": 1, "model": "typo"}'));
  await expect(element).toHaveAttribute("data-error", /wind\.model: expected one of/);
  await swaying(page);
  await element.evaluate((one) => one.setAttribute("wind", "breeze"));
  await expect(element).not.toHaveAttribute("data-error");
  expect(thrown).toEqual([]);
  expect(quiet.splice(0).join()).toContain("WindError: wind.model");
});

test.describe("the custom element says why it shows no trees", { tag: "@long" }, () => {
  const said = (page: Page) => page.locator("galewood-forest").getByRole("alert");
  /** The console has the same error, with its stack. */
  const logged = (quiet: string[]) => quiet.splice(0).join();

  test("without WebGL", async ({ page, quiet }) => {
    await page.addInitScript(() => {
      HTMLCanvasElement.prototype.getContext = () => null;
    });
    await countWorkers(page);
    await page.goto(`${await serving(EXAMPLES)}/element/`);
    await expect(said(page)).toContainText("WebGL 2 is switched off or missing");
    expect(await running(page)).toBe(0);
    expect(logged(quiet)).toContain("WebGL 2");
  });

  for (const [what, address, answer] of [
    ["a table is another file", "**/poplar.table", { body: "\x89PNG", contentType: "application/octet-stream" }],
    ["a mesh is another file", "**/poplar.glb", { body: "\x89PNG", contentType: "application/octet-stream" }],
    ["a server answers with its own page", "**/poplar.glb", { body: "<!doctype html>", contentType: "text/html" }],
  ] as const) {
    test(`where ${what}, with the address`, async ({ page, quiet }) => {
      await page.route(address, (route) => route.fulfill(answer));
      await page.goto(`${await serving(EXAMPLES)}/element/`);
      await expect(said(page)).toContainText(address.slice("**/".length));
      await expect(page.locator("canvas")).toHaveCount(0);
      expect(logged(quiet)).toContain(address.slice("**/".length));
    });
  }

  test("with a renderer that there is not", async ({ page, quiet }) => {
    await page.route("**/element/", async (route) => {
      const page = await (await route.fetch()).text();
      await route.fulfill({ body: page.replace(" src=", ' renderer="vulkan" src='), contentType: "text/html" });
    });
    await page.goto(`${await serving(EXAMPLES)}/element/`);
    await expect(said(page)).toContainText("renderer is webgl or webgpu, not vulkan");
    expect(logged(quiet)).toContain("not vulkan");
  });

  test("where no service answers", async ({ page, quiet }) => {
    await page.route("**/api/trees", (route) => route.fulfill({ body: "{}", contentType: "application/json" }));
    await page.route("**/element/", async (route) => {
      const page = await (await route.fetch()).text();
      await route.fulfill({ body: page.replace(/ src="[^"]*"/, ' service="/"'), contentType: "text/html" });
    });
    await page.goto(`${await serving(EXAMPLES)}/element/`);
    await expect(said(page)).toContainText("/api/trees: this is not the list of trees of a Galewood service");
    expect(logged(quiet)).toContain("/api/trees");
  });
});

test("react-three-fiber in strict mode: trees sway, and can be clicked", { tag: "@long" }, async ({ page }) => {
  await countWorkers(page);
  await bundled("r3f", "three", join(folder, "r3f"));
  await page.goto(`${await serving(join(folder, "r3f"))}/`);
  await swaying(page);
  const { width, height } = page.viewportSize() ?? { width: 0, height: 0 };
  await page.mouse.click(0.5 * width, 0.5 * height);
  await expect(page.locator("output")).toHaveText("Tree 1");
  expect(await running(page)).toBe(1);
});

test("a shared forest that the service streams: everyone sees a change of the wind", { tag: "@long" }, async ({ page, context }) => {
  const address = `${await serving(EXAMPLES, process.env.BASE_URL)}/streamed/?share=test-${Date.now()}`;
  // on a busy machine the timestamp of a frame lies long before its callback runs
  await page.addInitScript(() => {
    const next = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (callback) => next((now_ms) => callback(now_ms - 500));
  });
  await page.goto(address);
  await swaying(page);
  await expect(page.locator("output")).toHaveText("alone");
  const other = await context.newPage();
  await other.goto(address);
  await expect(page.locator("output")).toHaveText("2 are here");
  await expect(other.locator("output")).toHaveText("2 are here");
  await other.locator("select").selectOption("storm-front");
  await expect(page.locator("select")).toHaveValue("storm-front");
  await other.close();
  await expect(page.locator("output")).toHaveText("alone");
});

test("Babylon.js, moved by galewood/core", { tag: "@long" }, async ({ page }) => {
  await bundled("babylon", "three", join(folder, "babylon"));
  await page.goto(`${await serving(join(folder, "babylon"))}/`);
  await swaying(page);
});

/** Counts the workers that run in a page. */
async function countWorkers(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const counted = Object.assign(globalThis, { running: 0 });
    const Started = Worker;
    class Counted extends Started {
      private ended = false;
      constructor(address: string | URL, options?: WorkerOptions) {
        super(address, options);
        counted.running++;
      }
      override terminate(): void {
        if (!this.ended) counted.running--;
        this.ended = true;
        super.terminate();
      }
    }
    globalThis.Worker = Counted;
  });
}

const running = (page: Page) => page.evaluate(() => (globalThis as unknown as { running: number }).running);

/** What Chromium and three.js remark where WebGPURenderer draws by WebGL 2. */
const FALLBACK = /No available adapters|WebGPU is not available, running under WebGL2/;
const besidesFallback = (quiet: string[]) => quiet.splice(0).filter((text) => !FALLBACK.test(text));

// Without WebGPU its renderer draws by WebGL 2. It is still being loaded when the element is removed.
for (const [renderer, query] of [
  ["WebGLRenderer", ""],
  ["WebGPURenderer", "?webgpu"],
]) {
  test(`mounted, removed and mounted again, as by strict mode of React, ${renderer}: no error, no worker is left`, { tag: "@long" }, async ({ page, quiet }) => {
    await countWorkers(page);
    await page.goto(`${await serving(EXAMPLES)}/element/${query}`);
    const element = page.locator("galewood-forest");
    // more often than a browser allows contexts of WebGL
    await element.evaluate(async (one) => {
      const parent = one.parentElement as HTMLElement;
      for (let mount = 0; mount < 20; mount++) {
        one.remove();
        parent.append(one);
        await new Promise((done) => setTimeout(done, 10 * mount));
      }
    });
    await swaying(page);
    expect(await running(page)).toBe(1);
    await expect(page.locator("canvas")).toHaveCount(1);
    await expect(element).not.toHaveAttribute("data-error");
    await element.evaluate((one) => one.remove());
    expect(await running(page)).toBe(0);
    expect(besidesFallback(quiet)).toEqual([]);
  });
}

test("a wind that is set while WebGPURenderer is being loaded", { tag: "@long" }, async ({ page, quiet }) => {
  let release = () => {};
  const released = new Promise<void>((done) => {
    release = done;
  });
  await page.route("**/three.webgpu.js", async (route) => {
    await released;
    await route.continue();
  });
  await page.goto(`${await serving(EXAMPLES)}/element/?webgpu`);
  const forest = () =>
    page.locator("galewood-forest").evaluate((one) => (one as unknown as { forest: { wind: { model: string } } | null }).forest?.wind.model);
  await page.evaluate(() => customElements.whenDefined("galewood-forest"));
  expect(await forest()).toBeUndefined();
  await page.locator("galewood-forest").evaluate((one) => one.setAttribute("wind", "storm-front"));
  release();
  await expect.poll(forest).toBe("navier-stokes");
  expect(besidesFallback(quiet)).toEqual([]);
});

interface Shown {
  drawn: number;
  green: number;
}

test("a strict Content-Security-Policy, as docs/how-to/player.md has it", { tag: "@long" }, async ({ page }) => {
  const out = join(folder, "strict");
  await strictPage("strict.js", out);
  served = await site(out, { policy: "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'" });
  await page.goto(`${served.base}/`);
  const handle = await page.waitForFunction(() => (window as { found?: unknown }).found);
  const found = (await handle.jsonValue()) as Shown[] | string;
  expect(Array.isArray(found), `${found}`).toBe(true);
  for (const { drawn, green } of found as Shown[]) {
    expect(drawn).toBeGreaterThan(500);
    expect(green).toBeGreaterThan(0.3 * drawn);
  }
  expect(served.violations).toEqual([]);
});

interface Features {
  picked: number[];
  instance: number | null;
  beside: boolean;
  tip_m: number[];
  stand_m: number[];
  refused: string;
  time_s: number;
}

test("any material, any matrix, an inventory, shadows of three kinds of light, picking, a wind as a function", { tag: "@long" }, async ({ page }) => {
  const base = await serving(__dirname);
  await page.goto(`${base}/features.html`);
  const handle = await page.waitForFunction(() => (window as { features?: unknown }).features);
  const found = (await handle.jsonValue()) as Features;
  expect(found.picked).toEqual([0, 1, 2, 3, 4]);
  expect(found.instance).toBe(2);
  expect(found.beside).toBe(false);
  // The wind blows to +x.
  expect(found.tip_m[0]).toBeGreaterThan(0.02);
  // As tall as in the inventory, 12 m and 6 m; the wood ends below the topmost leaves.
  expect(found.stand_m[0]).toBeGreaterThan(11);
  expect(found.stand_m[0]).toBeLessThan(12.01);
  expect(found.stand_m[0] / found.stand_m[1]).toBeCloseTo(2, 3);
  expect(found.refused).toContain("use the GLB that belongs to it");
});
