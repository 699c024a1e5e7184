import { execFile } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

/**
 * Import rules and limits of biome.json and compiler configurations of core and worker: each violation below is
 * created in a temporary folder with the configuration of the project and must be rejected.
 */
const REPOSITORY = fileURLToPath(new URL("../..", import.meta.url));
const run = promisify(execFile);

let root = "";
beforeAll(() => {
  root = mkdtempSync(join(tmpdir(), "galewood-layers-"));
});
afterAll(() => rmSync(root, { recursive: true, force: true }));

function plant(folder: string, files: Record<string, string>): void {
  for (const [path, text] of Object.entries(files)) {
    mkdirSync(dirname(join(folder, path)), { recursive: true });
    writeFileSync(join(folder, path), text);
  }
}

/** Output of a program, and whether it succeeded. */
async function check(command: string, args: string[], cwd: string): Promise<{ passes: boolean; text: string }> {
  try {
    const { stdout, stderr } = await run(join(REPOSITORY, "node_modules/.bin", command), args, { cwd });
    return { passes: true, text: stdout + stderr };
  } catch (error) {
    const { stdout = "", stderr = "" } = error as { stdout?: string; stderr?: string };
    return { passes: false, text: stdout + stderr };
  }
}

let folders = 0;
async function lint(files: Record<string, string>) {
  const folder = join(root, `lint-${folders++}`);
  mkdirSync(folder);
  copyFileSync(join(REPOSITORY, "biome.json"), join(folder, "biome.json"));
  plant(folder, files);
  return check("biome", ["lint", "--colors=off", "."], folder);
}

const importing = (specifier: string) => `import { thing } from "${specifier}";\nexport const other = thing;\n`;
const importingType = (specifier: string) => `import type { Thing } from "${specifier}";\nexport type Other = Thing;\n`;

describe("biome rejects", () => {
  test.each([
    ["web/player/src/core/wind/planted.ts", "three", "core draws nothing"],
    ["web/player/src/core/wind/planted.ts", "three/addons/controls/OrbitControls.js", "core draws nothing"],
    ["web/player/src/core/wind/planted.ts", "../../worker/protocol", "core imports nothing from outside core"],
    ["web/player/src/core/wind/planted.ts", "../../trees/detail", "core imports nothing from outside core"],
    ["web/player/src/core/wind/planted.ts", "../../three/forest", "core imports nothing from outside core"],
    ["web/player/src/core/wind/planted.ts", "../../../../src/scene/quality", "core imports nothing from outside core"],
    ["web/player/src/core/wind/planted.ts", "galewood/trees", "The package uses its own files"],
    ["web/player/src/worker/planted.ts", "three", "The worker draws nothing"],
    ["web/player/src/worker/motion/planted.ts", "../../trees/culling/culling", "The worker imports core only"],
    ["web/player/src/worker/motion/planted.ts", "../../../../src/page/settings/settings", "The worker imports core only"],
    ["web/player/src/trees/planted.ts", "../three/forest", "The tree code imports core"],
    ["web/player/src/trees/planted.ts", "../worker/motion/blend", "The tree code imports core"],
    ["web/player/src/trees/nodes/planted.ts", "../../worker/protocol", "The tree code imports core"],
    ["web/player/src/trees/planted.ts", "../../../src/scene/sky/air", "The tree code imports core"],
    ["web/player/src/trees/planted.ts", "../../../src/page/app", "The tree code imports core"],
    ["web/player/src/three/planted.ts", "../../../src/page/app", "The package knows nothing of the page"],
    ["web/player/src/three/planted.ts", "../../../src/scene/sky/air", "The package knows nothing of the page"],
    ["web/player/src/three/planted.ts", "../webgpu/turn", "Nodes (TSL) belong to webgpu"],
    ["web/player/src/three/planted.ts", "three/tsl", "Nodes (TSL) belong to webgpu"],
    ["web/player/src/trees/planted.ts", "../webgpu/turn", "The tree code imports core"],
    ["web/player/src/trees/nodes/planted.ts", "three/webgpu", "Nodes (TSL) belong to webgpu"],
    ["web/player/src/webgpu/planted.ts", "../../../src/page/app", "The package knows nothing of the page"],
    ["web/player/src/planted.ts", "../../src/page/app", "The package knows nothing of the page"],
    ["web/player/src/planted.ts", "galewood/core", "The package uses its own files"],
    ["web/src/scene/sky/planted.ts", "../../page/app", "scene knows nothing of the page"],
    ["web/src/scene/sky/planted.ts", "galewood/client-worker", "scene starts no worker"],
    ["web/src/scene/sky/planted.ts", "../../../player/src/trees/culling/culling", "by its public subpaths"],
    ["web/src/page/planted.ts", "../../player/src/core/wind/document", "by its public subpaths"],
    ["web/src/page/ui/planted.ts", "../../../player/dist/core.js", "by its public subpaths"],
  ])("%s importing %s", async (file, specifier, message) => {
    for (const text of [importing(specifier), importingType(specifier)]) {
      const { passes, text: said } = await lint({ [file]: text });
      expect(passes, said).toBe(false);
      expect(said).toContain("lint/style/noRestrictedImports");
      expect(said).toContain(message);
    }
  });

  test.each([
    ["values", importing],
    ["types", importingType],
  ])("a cycle of %s", async (_, text) => {
    const files = { "web/src/page/a.ts": text("./b"), "web/src/page/b.ts": text("./c"), "web/src/page/c.ts": text("./a") };
    const { passes, text: said } = await lint(files);
    expect(passes, said).toBe(false);
    expect(said).toContain("lint/suspicious/noImportCycles");
  });
});

/** A function or a constructor with this many parameters. */
const names = (count: number) => Array.from({ length: count }, (_, k) => `p${k}`);
const taking = (count: number) =>
  `export const sum = (${names(count).map((name) => `${name}: number`).join(", ")}) => ${names(count).join(" + ")};\n`;
const madeOf = (count: number) =>
  `export class Planted {\n  constructor(${names(count).map((name) => `readonly ${name}: number`).join(", ")}) {}\n}\n`;

describe("the number of parameters", () => {
  test.each([
    ["web/player/src/core/planted.ts", taking(10)],
    ["web/player/src/three/planted.ts", madeOf(10)],
    ["web/scripts/planted.ts", taking(10)],
    ["tools/species/planted.ts", taking(10)],
    ["web/src/scene/planted.ts", taking(7)],
    ["web/src/page/planted.ts", madeOf(7)],
  ])("is limited in %s", async (file, text) => {
    const { passes, text: said } = await lint({ [file]: text });
    expect(passes, said).toBe(false);
    expect(said).toContain("lint/complexity/useMaxParams");
  });

  test("is allowed up to nine, in page and scene up to six", async () => {
    const { passes, text } = await lint({ "web/player/src/core/planted.ts": taking(9), "web/src/page/planted.ts": madeOf(6) });
    expect(passes, text).toBe(true);
  });
});

test("biome accepts the allowed imports", async () => {
  const { passes, text } = await lint({
    "web/player/src/core/math/planted.ts": importing("../wind/document"),
    "web/player/src/worker/motion/planted.ts": importing("../../core/table/table") + "export * from '../protocol';\n",
    "web/player/src/trees/planted.ts": importing("three/addons/loaders/GLTFLoader.js") + "export * from '../core/table/drawnTable';\n",
    "web/player/src/trees/nodes/planted.ts": importing("../drawList") + "export * from '../../core/motion/tip';\n",
    "web/player/src/three/planted.ts": importing("../trees/detail") + "export * from '../core/forest/givenWind';\n",
    "web/player/src/webgpu/planted.ts": importing("three/tsl") + "export * from '../three/view';\n",
    "web/src/scene/planted.ts": importing("galewood/trees") + "export * from 'galewood/client';\n",
    "web/src/page/planted.ts": importing("../scene/forest") + "export * from 'galewood/core';\n",
  });
  expect(passes, text).toBe(true);
});

describe("the compiler rejects", () => {
  test.each([
    ["core", "document.title", "document"],
    ["core", "window.innerWidth", "window"],
    ["core", "new WebSocket('')", "WebSocket"],
    ["core", "fetch('')", "fetch"],
    ["worker", "document.title", "document"],
    ["worker", "window.innerWidth", "window"],
  ])("in %s: %s", async (project, expression, name) => {
    const folder = join(root, `tsc-${folders++}`);
    const extended = JSON.stringify({
      extends: join(REPOSITORY, `web/tsconfig.${project}.json`),
      include: ["planted.ts", join(REPOSITORY, "web/core-globals.d.ts")].slice(0, project === "core" ? 2 : 1),
    });
    plant(folder, { "tsconfig.json": extended, "planted.ts": `export const planted = ${expression};\n` });
    const { passes, text } = await check("tsc", ["-p", "tsconfig.json"], folder);
    expect(passes, text).toBe(false);
    expect(text).toContain(`'${name}'`);
  });
});
