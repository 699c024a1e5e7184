import { defineConfig } from "vite";
import { precompress } from "./scripts/precompress";

const server = process.env.GALEWOOD_SERVER ?? "http://127.0.0.1:8000";

export default defineConfig({
  plugins: [precompress()],
  build: { target: "es2023", chunkSizeWarningLimit: 900, sourcemap: false },
  worker: { format: "es" },
  server: {
    proxy: {
      "/api": { target: server, changeOrigin: true },
      "/healthz": { target: server, changeOrigin: true },
      "/ws": { target: server.replace("http", "ws"), ws: true, changeOrigin: true },
    },
  },
});
