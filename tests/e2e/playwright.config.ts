import { defineConfig } from "@playwright/test";
import { LAUNCH } from "./chromium";

/**
 * Software rendering is slow: small viewport, few trees, one page at a time. A test that fails is tried once more, and
 * then reported as flaky if it passes: on a busy machine one of a hundred real browsers and servers may be starved.
 */
export default defineConfig({
  testDir: ".",
  testMatch: "*.spec.ts",
  outputDir: "results",
  globalSetup: "./setup.ts",
  workers: 1,
  retries: 1,
  timeout: 180_000,
  expect: { timeout: 60_000 },
  reporter: [["line"]],
  use: {
    viewport: { width: 320, height: 180 },
    screenshot: "only-on-failure",
    launchOptions: LAUNCH,
  },
});
