/** galewood/webgpu: the same trees at the same time as galewood/three, by WebGPURenderer on WebGPU and on WebGL 2. */
import type { Page, TestInfo } from "@playwright/test";
import { PNG } from "pngjs";
import { WEBGPU_LAUNCH } from "../chromium";
import { changedPixels, expect, type Picture, test } from "../forest";
import { standing, swaying } from "../swaying";
import { EXAMPLES, type Site, site } from "./examples";

test.use({ drawn: "always", launchOptions: WEBGPU_LAUNCH, viewport: { width: 480, height: 320 } });

let served: Site | null = null;
test.afterEach(() => {
  served?.close();
  served = null;
});

async function serving(root: string): Promise<string> {
  served = await site(root);
  return served.base;
}

/**
 * Skips the test where the browser has no adapter of WebGPU, as on machines whose Chromium lacks Vulkan. `origin`: WebGPU is
 * there for secure origins only; a `script` of it is shown as text.
 */
async function needWebgpu(page: Page, origin: string, script = "features.js"): Promise<void> {
  await page.goto(`${origin}/${script}`);
  const has = await page.evaluate(async () => {
    const { gpu } = navigator as { gpu?: { requestAdapter(): Promise<unknown> } };
    return Boolean(await gpu?.requestAdapter());
  });
  test.skip(!has, "this Chromium has no adapter of WebGPU");
}

interface Drawn {
  backend: string;
  picture: string;
  vertices: { vertices: number; worst: number; moved: number } | null;
}

/** What renderers.js reports of a renderer; its picture is kept beside the results of the test. */
async function drawnBy(page: Page, base: string, renderer: string, info: TestInfo): Promise<Drawn & { png: Picture }> {
  await page.goto(`${base}/renderers.html?${renderer}`);
  const handle = await page.waitForFunction(() => (window as { drawn?: unknown }).drawn);
  const drawn = (await handle.jsonValue()) as Drawn;
  const body = Buffer.from(drawn.picture.slice(drawn.picture.indexOf(",") + 1), "base64");
  await info.attach(renderer, { body, contentType: "image/png" });
  return { ...drawn, png: PNG.sync.read(body) };
}

for (const [name, renderer, backend] of [
  ["WebGPU", "webgpu", "WebGPU"],
  ["WebGL 2", "webgpu-webgl", "WebGL"],
]) {
  test(`vertices and pictures by WebGPURenderer on ${name} are those of the table and of WebGLRenderer`, async ({ page }, info) => {
    const base = await serving(__dirname);
    if (backend === "WebGPU") await needWebgpu(page, base);
    const usual = await drawnBy(page, base, "webgl", info);
    const found = await drawnBy(page, base, renderer, info);
    expect(found.backend).toBe(backend);
    expect(found.vertices?.vertices).toBeGreaterThan(10_000);
    expect(found.vertices?.moved).toBeGreaterThan(0.1); // of the height
    expect(found.vertices?.worst).toBeLessThan(1e-3);
    // Edges and shadows are smoothed differently. A tree that stands still makes nine times as many pixels differ.
    const { width, height } = usual.png;
    expect(changedPixels(usual.png, found.png, 32)).toBeLessThan(0.01 * width * height);
  });
}

interface Computed {
  steps: number;
  trees: number;
  worst: number;
  largest: number;
  bytesPerTree: number;
  refused: string;
}

test("compute shaders step trees as the processor does: to 1e-4 of the height over 1,000 steps", async ({ page }) => {
  const base = await serving(__dirname);
  await needWebgpu(page, base);
  await page.goto(`${base}/computed.html`);
  const handle = await page.waitForFunction(() => (window as { computed?: unknown }).computed);
  const found = (await handle.jsonValue()) as Computed;
  expect(found.steps).toBe(1000);
  expect(found.trees).toBe(140);
  expect(found.largest).toBeGreaterThan(0.1); // of the height
  expect(found.worst).toBeLessThan(1e-4);
  // Stated in docs/design/0035-webgpu.md: 24 oscillators and 30 modes twice each, commands with 32 places, 30 displayed coordinates.
  expect(found.bytesPerTree).toBe(4 * (2 * (24 + 30) + (5 + 2 * 32) + 30));
  expect(found.refused).toContain("400000 trees of a kind: this graphics device takes");
});

// The renderer itself chooses WebGL 2 where there is no WebGPU.
test("the example, with a material of nodes", { tag: "@long" }, async ({ page }) => {
  const base = await serving(EXAMPLES);
  await page.goto(`${base}/webgpu/index.html`);
  await swaying(page);
});

test("the custom element by WebGPURenderer: the picture of WebGLRenderer, and trees that sway", { tag: "@long" }, async ({ page }, info) => {
  const base = await serving(EXAMPLES);
  await needWebgpu(page, base, "plain/scene.js");
  await page.route(/\/element\/(\?webgpu)?$/, async (route) => {
    const body = await (await route.fetch()).text();
    await route.fulfill({ body: body.replace('wind="autumn-gusts"', 'wind="still"'), contentType: "text/html" });
  });
  const pictures: Picture[] = [];
  for (const query of ["", "?webgpu"]) {
    await page.goto(`${base}/element/${query}`);
    pictures.push(await standing(page));
    await info.attach(`element${query}`, { body: await page.screenshot(), contentType: "image/png" });
  }
  const drawsBy = (kind: string) => page.locator("canvas").evaluate((one, kind) => (one as HTMLCanvasElement).getContext(kind) !== null, kind);
  expect(await drawsBy("webgpu")).toBe(true);
  const [usual, found] = pictures;
  expect(changedPixels(usual, found, 32)).toBeLessThan(0.01 * usual.width * usual.height);
  await page.locator("galewood-forest").evaluate((one) => one.setAttribute("wind", "storm-front"));
  await swaying(page);
  await page.locator("galewood-forest").evaluate((one) => one.remove());
  await expect(page.locator("canvas")).toHaveCount(0);
});
