/** Vertex animation textures: the exported decoders move the vertices, on the graphics card, to where the table draws
 * them. */
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { expect, test } from "@playwright/test";

const REPOSITORY = resolve(__dirname, "../../..");
const THREE = join(REPOSITORY, "node_modules/three");
const ORIGIN = "http://exports.test";
const PAGE = `<!doctype html><title>decoders</title>
<script type="importmap">{ "imports": {
  "three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"
} }</script><script type="module" src="/exportedDecoders.js"></script>`;
const TYPES: Record<string, string> = { js: "text/javascript", json: "application/json" };
const folder = mkdtempSync(join(tmpdir(), "galewood-exports-"));

interface Decoded {
  three: number;
  instance: number;
  godot: number;
  unity: number;
  sway: number;
  pixels: number;
  instances: number;
  meshes: number;
}

test.beforeAll(() => {
  const own = join(REPOSITORY, ".venv/bin/python");
  const python = existsSync(own) ? own : "python3";
  execFileSync(python, ["-m", "tests.e2e.exports.write_exports", folder], { cwd: REPOSITORY });
});

test.afterAll(() => rmSync(folder, { recursive: true, force: true }));

/** The file of an address: of three.js, of the export, or the script beside this test. */
function fileOf(path: string): string {
  if (path.startsWith("/three/")) return join(THREE, path.slice("/three/".length));
  return path === "/exportedDecoders.js" ? join(__dirname, path) : join(folder, path);
}

test("the decoders for three.js, Godot and Unity agree with the table", async ({ page }) => {
  const errors: string[] = [];
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  await page.route(`${ORIGIN}/**`, (route) => {
    const { pathname } = new URL(route.request().url());
    if (pathname === "/") return route.fulfill({ contentType: "text/html", body: PAGE });
    if (!existsSync(fileOf(pathname))) return route.fulfill({ status: 404 });
    const contentType = TYPES[pathname.slice(pathname.lastIndexOf(".") + 1)] ?? "application/octet-stream";
    return route.fulfill({ contentType, body: readFileSync(fileOf(pathname)) });
  });
  await page.goto(`${ORIGIN}/`);
  await page.waitForFunction(() => "decoded" in window).catch(() => expect(errors).toEqual([]));
  const decoded = await page.evaluate(() => (window as unknown as { decoded: Decoded }).decoded);
  expect(errors.filter((text) => !text.includes("404"))).toEqual([]);
  expect(decoded.meshes).toBe(3);
  expect(decoded.pixels).toBeGreaterThan(500);
  expect(decoded.instances).toBeGreaterThan(decoded.pixels);
  expect(decoded.sway).toBeGreaterThan(1);
  expect(decoded.three).toBeLessThan(0.1);
  expect(decoded.instance).toBeLessThan(0.1);
  expect(decoded.godot).toBeLessThan(0.1);
  expect(decoded.unity).toBeLessThan(0.1);
});
