/** Builds the package into dist/. Entry points that are used together share chunks, so that nothing is there twice. */
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { rolldown } from "rolldown";
import { shorterShaders } from "./shorterShaders.mjs";
import { shortNames } from "./shortNames.mjs";

const HERE = dirname(fileURLToPath(import.meta.url));
const DIST = join(HERE, "dist");
const source = (name) => join(HERE, "src", `${name}.ts`);
const isThree = (id) => /^three(\/|$)/.test(id);

const options = (plugins = []) => ({
  plugins: [...plugins, shortNames, shorterShaders],
  checks: { pluginTimings: false },
});
const output = { format: "esm", minify: true, comments: { legal: true, annotation: false, jsdoc: false } };

/** Writes entry points; `groups`: chunks that they share; `external`: what is imported when the package is used. */
async function write(names, { groups = [], external = isThree, plugins } = {}) {
  const bundle = await rolldown({
    ...options(plugins),
    input: Object.fromEntries(Object.entries(names).map(([name, from]) => [name, source(from)])),
    external,
  });
  await bundle.write({
    ...output,
    dir: DIST,
    sourcemap: true,
    codeSplitting: { groups },
    entryFileNames: "[name].js",
    chunkFileNames: "[name].chunk.js",
  });
  await bundle.close();
}

/** The source of the worker, in one piece, as a module. */
async function workerSource() {
  const bundle = await rolldown({ ...options(), input: source("worker") });
  const { output: chunks } = await bundle.generate(output);
  await bundle.close();
  return `export default ${JSON.stringify(chunks[0].code)};`;
}

/** The module "virtual:worker". */
const inOne = {
  name: "worker-source",
  resolveId: (id) => (id === "virtual:worker" ? "\0worker" : null),
  load: (id) => (id === "\0worker" ? workerSource() : null),
};

rmSync(DIST, { recursive: true, force: true });
// What plays tables is in one file, because pages and workers share it.
await write(
  { core: "core", three: "three", "galewood.worker": "worker" },
  { groups: [{ name: "core", test: /\/src\/(core|worker)\// }] },
);
// The custom element uses the other entry points, as a page would.
const entries = /^\.\/(core|three|webgpu)$/;
await write(
  { element: "element" },
  {
    plugins: [
      {
        name: "entries",
        resolveId: (id) => (entries.test(id) ? { id: `${id}.js`, external: "relative" } : null),
      },
    ],
  },
);
// A page has one renderer: what both have in common is in both files.
await write({ webgpu: "webgpu" });
await write({ compute: "compute" });
// Streams have their own files, so that nobody else loads what they need.
await write({ stream: "stream" });
await write({ "galewood.stream.worker": "streamWorker" });
await write({ inventory: "inventory" });
await write({ workers: "worker/divided/severalWorkers" });
// Building blocks share code with each other, not with the entry points above.
const blocks = ["trees", "wind", "motion", "random", "client"];
await write(Object.fromEntries(blocks.map((name) => [name, name])), {
  groups: [{ name: "blocks", test: /\/src\/(core|worker)\// }],
});
await write({ "galewood.client.worker": "clientWorker" });
// A notebook's widget is one file, with three.js and the worker.
const widget = await rolldown({ ...options([inOne]), input: { widget: source("notebook/widget") } });
await widget.write({ ...output, dir: join(DIST, "notebook") });
await widget.close();
// The licences of what is inside these files.
mkdirSync(join(DIST, "licences"));
for (const name of ["@msgpack/msgpack", "three"])
  copyFileSync(
    join(HERE, "../../node_modules", name, "LICENSE"),
    join(DIST, "licences", `${basename(name)}.txt`),
  );
const tsc = join(HERE, "../../node_modules/typescript/bin/tsc");
execFileSync(process.execPath, [tsc, "-p", join(HERE, "tsconfig.json")], { stdio: "inherit" });
// Node's way of finding modules needs the endings, which the sources leave out.
const types = join(DIST, "types");
for (const name of readdirSync(types, { recursive: true }).filter((one) => one.endsWith(".d.ts"))) {
  const text = readFileSync(join(types, name), "utf8");
  writeFileSync(join(types, name), text.replace(/\b((?:from|import\(|import) *")(\.[^"]+)"/g, '$1$2.js"'));
}
