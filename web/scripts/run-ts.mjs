// Runs a TypeScript script under Node 20 (which cannot strip types) through Vite: node run-ts.mjs FILE
import { resolve } from "node:path";
import { runnerImport } from "vite";

await runnerImport(resolve(process.argv[2]), {
  configFile: false,
  logLevel: "error",
  ssr: { noExternal: ["galewood"], resolve: { conditions: ["galewood-source", "module", "node"] } },
});
