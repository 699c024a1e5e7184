/** The npm package of the built-in trees as strangers get it: packed, unpacked elsewhere, and bundled. */
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { build } from "vite";
import { afterAll, beforeAll, expect, test, vi } from "vitest";
import { createForest, PRESETS, readTable } from "../../../web/player/src/core";
import { openMesh } from "../../../web/player/src/trees/mesh/openMesh";
import { openedMeshes } from "../../../web/player/src/trees/mesh/treeMesh";
import type { BuiltinTree } from "../../../web/trees/tree";

const SOURCE = fileURLToPath(new URL("../../../web/trees/", import.meta.url));
const LISTED = fileURLToPath(new URL("../../../assets/species/species.json", import.meta.url));
const IDS = (JSON.parse(readFileSync(LISTED, "utf8")) as { id: string }[]).map(({ id }) => id);
let folder = "";
let installed = "";
let trees: readonly BuiltinTree[] = [];

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), "galewood-trees-"));
  const pack = ["pack", "--json", "--offline", "--pack-destination", folder];
  execFileSync("npm", pack, { cwd: SOURCE, stdio: ["ignore", "pipe", "ignore"] });
  const { version } = JSON.parse(readFileSync(`${SOURCE}package.json`, "utf8")) as { version: string };
  installed = join(folder, "node_modules/galewood-trees");
  mkdirSync(installed, { recursive: true });
  const archive = join(folder, `galewood-trees-${version}.tgz`);
  execFileSync("tar", ["-xzf", archive, "-C", installed, "--strip-components=1"]);
  const index = pathToFileURL(join(installed, "dist/index.js")).href;
  ({ TREES: trees } = (await import(/* @vite-ignore */ index)) as { TREES: readonly BuiltinTree[] });
}, 60_000);

afterAll(() => rmSync(folder, { recursive: true, force: true }));

const bytes = (url: string) => new Uint8Array(readFileSync(fileURLToPath(url)));

test("the package holds every built-in tree, with licence and types", () => {
  expect(trees.map(({ id }) => id)).toEqual(IDS);
  for (const file of ["LICENSE", "README.md", "dist/index.d.ts", "dist/tree.d.ts"]) {
    expect(existsSync(join(installed, file)), file).toBe(true);
  }
  expect(existsSync(join(installed, "build.mjs"))).toBe(false);
});

test("the types name every species", () => {
  const types = readFileSync(join(installed, "dist/tree.d.ts"), "utf8");
  const union = types.slice(types.indexOf("type TreeSpecies"), types.indexOf("type TreeId"));
  const named = [...union.matchAll(/"(\w+)"/g)].map(([, name]) => name);
  expect(new Set(named)).toEqual(new Set(trees.map(({ species }) => species)));
});

test.each(IDS)("%s sways in its package", { timeout: 60_000 }, async (id) => {
  const { default: tree } = (await import(
    /* @vite-ignore */ pathToFileURL(join(installed, `dist/${id}.js`)).href
  )) as { default: BuiltinTree };
  expect(tree.meshUrl.startsWith(pathToFileURL(installed).href)).toBe(true);
  vi.stubGlobal("self", globalThis);
  const pictures: Blob[] = [];
  vi.stubGlobal("createImageBitmap", (from: Blob) => {
    pictures.push(from);
    return Promise.resolve({ width: 4, height: 4, close() {} });
  });
  const { meshes } = openedMeshes(await openMesh(bytes(tree.meshUrl).buffer));
  vi.unstubAllGlobals();
  expect(pictures.map(({ type }) => type)).toEqual(Array(3).fill("image/webp"));
  for (const picture of pictures) {
    expect(new TextDecoder("latin1").decode((await picture.arrayBuffer()).slice(8, 12))).toBe("WEBP");
  }
  const vertices = meshes.map(({ positions }) => positions.length / 3);
  const rest_m = Float32Array.from(meshes.flatMap(({ positions }) => [...positions]));
  expect(tree.bareTableUrl === null).toBe(["spruce", "pine"].includes(tree.species));
  for (const url of [tree.tableUrl, tree.bareTableUrl]) {
    if (url === null) continue;
    const table = readTable(bytes(url));
    expect(table.metadata.species).toBe(tree.species);
    expect(Math.abs(table.metadata.height_m - tree.height_m)).toBeLessThan(0.05 * tree.height_m);
    const count = vertices.reduce((sum, one) => sum + one, 0);
    expect(table.metadata.primitives.map((one) => one.vertices)).toEqual(vertices);
    const forest = createForest({ kinds: [{ table, places: [{ x_m: 0, z_m: 0 }] }], wind: PRESETS["storm-front"] });
    for (let k = 0; k < 90; k++) forest.step(1 / 30);
    const moved_m = forest.vertices(0, rest_m);
    expect(moved_m).toHaveLength(3 * count);
    const farthest_m = moved_m.reduce((most, x, k) => Math.max(most, Math.abs(x - rest_m[k])), 0);
    expect(farthest_m).toBeGreaterThan(0.02 * tree.height_m);
    expect(farthest_m).toBeLessThan(0.6 * tree.height_m);
  }
});

test("a bundler takes along the files of the trees that a page imports, and no others", { timeout: 60_000 }, async () => {
  writeFileSync(join(folder, "app.js"), 'import maple from "galewood-trees/maple";\nconsole.log(maple.tableUrl, maple.meshUrl);\n');
  const built = await build({
    root: folder,
    configFile: false,
    logLevel: "error",
    build: { write: false, rolldownOptions: { input: join(folder, "app.js") } },
  });
  const [{ output }] = [built].flat() as { output: { fileName: string }[] }[];
  const kept = output.map(({ fileName }) => fileName.replace(/-[\w-]{8}(?=\.\w+$)/, "").replace("assets/", ""));
  expect(kept.filter((name) => !name.endsWith(".js")).sort()).toEqual(["maple.bare.table", "maple.glb", "maple.table"]);
});
