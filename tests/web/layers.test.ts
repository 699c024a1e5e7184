import { execFile } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

/**
 * Import rules of web/biome.json and compiler configurations of core and worker: each violation below is created in a
 * temporary folder with the configuration of the project and must be rejected.
 */
const WEB = fileURLToPath(new URL("../../web", import.meta.url));
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
    const { stdout, stderr } = await run(join(WEB, "node_modules/.bin", command), args, { cwd });
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
  copyFileSync(join(WEB, "biome.json"), join(folder, "biome.json"));
  plant(folder, files);
  return check("biome", ["lint", "--colors=off", "."], folder);
}

const importing = (specifier: string) => `import { thing } from "${specifier}";\nexport const other = thing;\n`;
const importingType = (specifier: string) => `import type { Thing } from "${specifier}";\nexport type Other = Thing;\n`;

describe("biome rejects", () => {
  test.each([
    ["src/core/wind/planted.ts", "three", "core draws nothing"],
    ["src/core/wind/planted.ts", "three/addons/controls/OrbitControls.js", "core draws nothing"],
    ["src/core/planted.ts", "../worker/protocol", "core imports nothing from outside core"],
    ["src/core/wind/planted.ts", "../../scene/quality", "core imports nothing from outside core"],
    ["src/core/wind/planted.ts", "../../page/settings/settings", "core imports nothing from outside core"],
    ["src/worker/planted.ts", "three", "The worker draws nothing"],
    ["src/worker/motion/planted.ts", "../../scene/trees/culling", "worker imports core only"],
    ["src/worker/motion/planted.ts", "../../page/settings/settings", "worker imports core only"],
    ["src/scene/trees/planted.ts", "../sky/air", "scene/trees imports core"],
    ["src/scene/trees/planted.ts", "../season/season", "scene/trees imports core"],
    ["src/scene/trees/planted.ts", "../forest", "scene/trees imports core"],
    ["src/scene/trees/planted.ts", "../../page/app", "scene/trees imports core"],
    ["src/scene/trees/planted.ts", "../../worker/motion/blend", "scene/trees imports core"],
    ["src/scene/trees/nodes/planted.ts", "../../sky/air", "scene/trees imports core"],
    ["src/scene/trees/nodes/planted.ts", "../../../page/app", "scene/trees imports core"],
    ["src/scene/sky/planted.ts", "../../page/app", "scene knows nothing of the page"],
    ["src/scene/planted.ts", "../worker/motion/blend", "scene takes types from the worker's protocol only"],
    ["src/page/ui/planted.ts", "../../worker/motion/blend", "page takes types from the worker's protocol only"],
    ["player/src/core/planted.ts", "three", "the worker draw nothing"],
    ["player/src/worker/planted.ts", "../../../src/scene/trees/culling", "the worker draw nothing"],
    ["player/src/three/planted.ts", "../../../src/page/app", "The package shares core, scene/trees"],
    ["player/src/three/planted.ts", "../../../src/scene/sky/air", "The package shares core, scene/trees"],
    ["player/src/planted.ts", "../../src/worker/motion/blend", "The package shares core, scene/trees"],
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
    const files = { "src/core/a.ts": text("./b"), "src/core/b.ts": text("./c"), "src/core/c.ts": text("./a") };
    const { passes, text: said } = await lint(files);
    expect(passes, said).toBe(false);
    expect(said).toContain("lint/suspicious/noImportCycles");
  });
});

test("biome accepts the allowed imports", async () => {
  const { passes, text } = await lint({
    "src/core/math/planted.ts": importing("../wind/document"),
    "src/worker/motion/planted.ts": importing("../../core/table/table") + "export * from '../protocol';\n",
    "src/scene/trees/planted.ts": importing("../../core/math/random") + "export * from '../../worker/protocol';\n",
    "src/scene/trees/nodes/planted.ts": importing("../drawList") + "export * from '../../../worker/protocol';\n",
    "src/scene/planted.ts": importing("./trees/speciesForest") + "export * from '../worker/protocol';\n",
    "src/page/planted.ts": importing("../scene/forest") + "export * from '../worker/protocol';\n",
    "player/src/core/planted.ts": importing("../../../src/core/table/present"),
    "player/src/three/planted.ts": importing("../../../src/scene/trees/detail") + "export * from '../core/wind';\n",
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
      extends: join(WEB, `tsconfig.${project}.json`),
      include: ["planted.ts", join(WEB, "core-globals.d.ts")].slice(0, project === "core" ? 2 : 1),
    });
    plant(folder, { "tsconfig.json": extended, "planted.ts": `export const planted = ${expression};\n` });
    const { passes, text } = await check("tsc", ["-p", "tsconfig.json"], folder);
    expect(passes, text).toBe(false);
    expect(text).toContain(`'${name}'`);
  });
});
