import { fileURLToPath } from "node:url";
import { defineConfig } from "vitest/config";

const here = (path: string) => fileURLToPath(new URL(path, import.meta.url));

/** The package galewood comes from its sources. */
const SOURCES = ["galewood-source", "module", "node", "development|production"];

/** The tests are in ../tests/web, outside the folder of node_modules, so packages are resolved from here. */
export default defineConfig({
  root: here(".."),
  resolve: {
    conditions: SOURCES,
    alias: [
      { find: /^vitest$/, replacement: here("node_modules/vitest") },
      { find: /^three$/, replacement: here("node_modules/three/build/three.module.js") },
      { find: /^three\/addons\//, replacement: here("node_modules/three/examples/jsm/") },
      { find: /^three\/examples\//, replacement: here("node_modules/three/examples/") },
    ],
  },
  ssr: { resolve: { conditions: SOURCES } },
  server: { fs: { allow: [here("..")] } },
  test: { include: ["tests/web/**/*.test.ts"], environment: "node", testTimeout: 60_000 },
});
