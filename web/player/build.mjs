/** Builds the package into dist/: entry points and the worker share chunks, so that nothing is there twice. */
import { execFileSync } from "node:child_process";
import { rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { rolldown } from "rolldown";
import { shortNames } from "./shortNames.mjs";

const HERE = dirname(fileURLToPath(import.meta.url));
const DIST = join(HERE, "dist");
const source = (name) => join(HERE, "src", `${name}.ts`);

rmSync(DIST, { recursive: true, force: true });
/** Shader code without comments, and without spaces where it is neither a directive nor TypeScript. */
const shorterShaders = {
  name: "shorter-shaders",
  transform: {
    filter: { id: /\.ts$/, code: /\/\* glsl \*\// },
    handler: (code) =>
      code.replace(/\/\* glsl \*\/ `[^`]*`/g, (text) =>
        text
          .slice("/* glsl */ ".length)
          .replace(/\/\*[\s\S]*?\*\/|\/\/.*$/gm, "")
          .replace(/\s*\n\s*/g, "\n")
          .replace(/^[^#\n$]*$/gm, (line) => line.replace(/ *([=+\-*/,;(){}<>?:]) */g, "$1")),
      ),
  },
};

const bundle = await rolldown({
  plugins: [shortNames, shorterShaders],
  input: {
    core: source("core"),
    three: source("three"),
    element: source("element"),
    "galewood.worker": source("worker"),
  },
  external: [/^three(\/|$)/],
});
await bundle.write({
  dir: DIST,
  format: "esm",
  minify: true,
  codeSplitting: { groups: [{ name: "core", test: /\/src\/(core|worker)\// }] },
  entryFileNames: "[name].js",
  chunkFileNames: "[name].chunk.js",
});
await bundle.close();
const tsc = join(HERE, "../node_modules/typescript/bin/tsc");
execFileSync(process.execPath, [tsc, "-p", join(HERE, "tsconfig.json")], { stdio: "inherit" });
