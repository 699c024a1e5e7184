import { defineConfig } from "@playwright/test";
import { LAUNCH } from "./chromium";

/** Software rendering is slow: small viewport, few trees, one page at a time. */
export default defineConfig({
  testDir: ".",
  testMatch: "*.spec.ts",
  outputDir: "results",
  globalSetup: "./setup.ts",
  workers: 1,
  timeout: 600_000,
  expect: { timeout: 120_000 },
  reporter: [["line"]],
  use: {
    viewport: { width: 320, height: 180 },
    screenshot: "only-on-failure",
    launchOptions: LAUNCH,
  },
});
