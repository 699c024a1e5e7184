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

/** Writes entry points; `groups`: chunks that they share. */
async function write(names, groups = []) {
  const bundle = await rolldown({
    plugins: [shortNames, shorterShaders],
    input: Object.fromEntries(Object.entries(names).map(([name, from]) => [name, source(from)])),
    external: [/^three(\/|$)/],
  });
  await bundle.write({
    dir: DIST,
    format: "esm",
    minify: true,
    codeSplitting: { groups },
    entryFileNames: "[name].js",
    chunkFileNames: "[name].chunk.js",
  });
  await bundle.close();
}

// What plays tables is in one file, because pages and workers share it.
const playing = { core: "core", three: "three", element: "element", "galewood.worker": "worker" };
await write(playing, [{ name: "core", test: /\/src\/(core|worker)\// }]);
// Streams have their own, so that nobody else loads what they need.
await write({ stream: "stream" });
await write({ "galewood.stream.worker": "streamWorker" });
// Files of measurements and inventories: read once, by few.
await write({ inventory: "inventory", measured: "measured" }, [
  { name: "files", test: /\/(core\/files|files|papaparse)\// },
]);
// Building blocks share code with each other, not with what is above: nobody needs both.
const blocks = ["trees", "wind", "motion", "random", "client"];
await write(Object.fromEntries(blocks.map((name) => [name, name])), [
  { name: "blocks", test: /\/src\/(core|worker)\// },
]);
await write({ "galewood.client.worker": "clientWorker" });

/** The source of the worker, in one piece, as a module. */
async function workerSource() {
  const bundle = await rolldown({ plugins: [shortNames, shorterShaders], input: source("worker") });
  const { output } = await bundle.generate({ format: "esm", minify: true });
  await bundle.close();
  return `export default ${JSON.stringify(output[0].code)};`;
}

// A notebook's widget is one file, with three.js and the worker.
const inOne = {
  name: "worker-source",
  resolveId: (id) => (id === "virtual:worker" ? "\0worker" : null),
  load: (id) => (id === "\0worker" ? workerSource() : null),
};
const widget = await rolldown({
  plugins: [inOne, shortNames, shorterShaders],
  input: { widget: source("notebook") },
});
await widget.write({ dir: join(DIST, "notebook"), format: "esm", minify: true });
await widget.close();
const tsc = join(HERE, "../node_modules/typescript/bin/tsc");
execFileSync(process.execPath, [tsc, "-p", join(HERE, "tsconfig.json")], { stdio: "inherit" });
