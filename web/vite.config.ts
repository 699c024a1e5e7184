import { defaultClientConditions, defineConfig } from "vite";
import { precompress } from "./scripts/precompress.ts";

const server = process.env.GALEWOOD_SERVER ?? "http://127.0.0.1:8000";

export default defineConfig({
  plugins: [precompress()],
  // The package galewood comes from its sources, so that it need not be built first.
  resolve: { conditions: ["galewood-source", ...defaultClientConditions] },
  build: {
    target: "es2023",
    chunkSizeWarningLimit: 900,
    sourcemap: false,
    rolldownOptions: {
      // three.js changes less often than the page.
      output: {
        codeSplitting: { groups: [{ name: "three", test: /\/node_modules\/three\/(build|src)\// }] },
      },
      checks: { pluginTimings: false },
    },
  },
  worker: { format: "es" },
  server: {
    proxy: {
      "/api": { target: server, changeOrigin: true },
      "/healthz": { target: server, changeOrigin: true },
      "/ws": { target: server.replace("http", "ws"), ws: true, changeOrigin: true },
    },
  },
});
