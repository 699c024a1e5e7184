/** galewood/webgpu: the same trees at the same time as galewood/three, by WebGPURenderer on WebGPU and on WebGL 2. */
import type { Page, TestInfo } from "@playwright/test";
import { PNG } from "pngjs";
import { WEBGPU_LAUNCH } from "../chromium";
import { changedPixels, expect, type Picture, test } from "../forest";
import { swaying } from "../swaying";
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

/** Skips the test where the browser has no adapter of WebGPU, as on machines whose Chromium lacks Vulkan. */
async function needWebgpu(page: Page): Promise<void> {
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
    const usual = await drawnBy(page, base, "webgl", info);
    if (backend === "WebGPU") await needWebgpu(page);
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

test("the example, with a material of nodes", { tag: "@long" }, async ({ page }) => {
  const base = await serving(EXAMPLES);
  await page.goto(`${base}/webgpu/index.html`);
  await needWebgpu(page);
  await swaying(page);
});
