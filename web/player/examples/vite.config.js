/** Serves the examples with the built-in trees: npm run examples */
import { createReadStream, existsSync } from "node:fs";
import { basename, join } from "node:path";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const TREES = here("../../../assets/species/shipped");

/** The built-in trees at /trees/. */
const trees = {
  name: "trees",
  configureServer({ middlewares }) {
    middlewares.use("/trees", (request, answer, next) => {
      const file = join(TREES, basename(new URL(request.url, "http://localhost").pathname));
      if (existsSync(file)) createReadStream(file).pipe(answer);
      else next();
    });
  },
};

export default defineConfig({
  root: here("."),
  plugins: [trees],
  optimizeDeps: { exclude: ["galewood"] },
  server: { fs: { allow: [here("../../..")] } },
});
