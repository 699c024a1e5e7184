/**
 * Draws exports in Chromium and writes PNGs: node inBrowser.mjs REQUEST.json, run from the repository.
 *
 * The request is a list of { program: "three" | "babylon" | "playcanvas", folder, file, time_s, height_m, picture }.
 */
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "@playwright/test";
import { build } from "esbuild";

const HERE = dirname(fileURLToPath(import.meta.url));
const ORIGIN = "http://pictures.test";
const SIDE_PX = { width: 320, height: 380 };
const BABYLON_PAGE = "tests/e2e/exports/liveTree.js";
const SYSTEM_CHROMIUM = "/usr/bin/chromium";
const THREE = {
  three: "/three/build/three.module.js",
  "three/addons/": "/three/examples/jsm/",
};
const browser = await chromium.launch({
  ...(existsSync(SYSTEM_CHROMIUM) && { executablePath: SYSTEM_CHROMIUM }),
  args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
});
const canvas = `<canvas width="${SIDE_PX.width}" height="${SIDE_PX.height}"></canvas>`;
const html = `<!doctype html><style>body { margin: 0 } canvas { display: block }</style>${canvas}
<script type="importmap">${JSON.stringify({ imports: THREE })}</script><script type="module" src="/page.js"></script>`;
const bundled = async (page) => {
  const { outputFiles } = await build({ entryPoints: [page], bundle: true, format: "esm", write: false, logLevel: "error" });
  return outputFiles[0].text;
};
const pages = {
  three: readFileSync(join(HERE, "threePage.js"), "utf8"),
  babylon: await bundled(BABYLON_PAGE),
  playcanvas: await bundled(join(HERE, "playcanvasPage.js")),
};

for (const { program, folder, file, time_s, height_m, picture } of JSON.parse(readFileSync(process.argv[2], "utf8"))) {
  const page = await browser.newPage({ viewport: SIDE_PX });
  page.on("pageerror", (error) => console.error(picture, error.message));
  const bodyOf = (path) => {
    if (path === "/page.js") return pages[program];
    if (path.startsWith("/three/")) return readFileSync(join("node_modules", path));
    return readFileSync(join(folder, path));
  };
  await page.route(`${ORIGIN}/**`, (route) => {
    const { pathname } = new URL(route.request().url());
    if (pathname === "/") return route.fulfill({ contentType: "text/html", body: html });
    if (pathname === "/favicon.ico") return route.fulfill({ status: 404 });
    const type = pathname.endsWith(".js") ? { contentType: "text/javascript" } : {};
    return route.fulfill({ ...type, body: bodyOf(pathname) });
  });
  await page.goto(`${ORIGIN}/`);
  await page.waitForFunction(() => window.ready, undefined, { timeout: 120_000 });
  if (program === "babylon") await page.evaluate(() => window.play(90, [14, 0]));
  else await page.evaluate((asked) => window.draw(...asked), [file, time_s, height_m]);
  await page.screenshot({ path: picture });
  await page.close();
}
await browser.close();
