/**
 * What a worker's frames cost outside a browser, as JSON: forests of 1,000 to 300,000 trees, and the wind of 10,000 for each model:
 * `npm run --silent bench-worker`.
 */
import { benchForest } from "./bench/forest";
import { benchWind } from "./bench/wind";

const FOREST_SIZES = [1000, 10_000, 100_000, 300_000];

const PRESETS_USED = ["breeze", "storm-front"] as const;

const forests = PRESETS_USED.flatMap((preset) =>
  FOREST_SIZES.map((trees) => ({ preset, trees, ...benchForest(preset, trees) })),
);
benchWind(10_000, 30); // warm-up
console.log(JSON.stringify({ forests, wind: { trees: 10_000, ...benchWind() } }, null, 2));
