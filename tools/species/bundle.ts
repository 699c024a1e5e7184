/** Bundles the generator of individuals into dist: one file that Node runs without any package. */
import { copyFileSync, mkdirSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { rolldown } from "rolldown";
import { PACKAGES, withoutPictures } from "./bundle-sources";

const GENERATOR_FOLDER = dirname(fileURLToPath(import.meta.url));
const BUILT_FOLDER = join(GENERATOR_FOLDER, "dist");
/** Packages whose code is in the file, each with its file of the licence. */
const BUNDLED_PACKAGES = [
  ["@dgreenheck/ez-tree", "LICENSE"],
  ["three", "LICENSE"],
  ["@gltf-transform/core", "LICENSE.md"],
  ["property-graph", "LICENSE"],
];

async function bundle() {
  const build = await rolldown({
    input: join(GENERATOR_FOLDER, "grow-individual.ts"),
    platform: "node",
    plugins: [withoutPictures],
    checks: { pluginTimings: false },
  });
  await build.write({
    format: "esm",
    minify: true,
    comments: { legal: true, annotation: false, jsdoc: false },
    file: join(BUILT_FOLDER, "grower.mjs"),
    codeSplitting: false,
  });
  await build.close();
}

rmSync(BUILT_FOLDER, { recursive: true, force: true });
mkdirSync(join(BUILT_FOLDER, "licences"), { recursive: true });
await bundle();
for (const [name, licence] of BUNDLED_PACKAGES)
  copyFileSync(
    join(PACKAGES, name, licence),
    join(BUILT_FOLDER, "licences", `${name.replaceAll("/", "-")}.txt`),
  );
