import { defineConfig } from "vitest/config";

/** The package galewood comes from its sources. */
const SOURCES = ["galewood-source", "module", "node", "development|production"];

export default defineConfig({
  resolve: { conditions: SOURCES },
  ssr: { resolve: { conditions: SOURCES } },
  test: { include: ["tests/{web,tools}/**/*.test.ts"], environment: "node", testTimeout: 60_000 },
});
