/** Steps the same forest by compute shaders and by galewood/core, and reports how far apart they are. */
import { createForest, PRESETS } from "galewood/core";
import { ComputedForest, readTable } from "galewood/compute";
import { WebGPURenderer } from "three/webgpu";

const STEP_S = 1 / 30;
const STEPS = 1000;
/** Still air at the end, in which trees come to rest. */
const WINDS = [
  [0, PRESETS["storm-front"]],
  [500, PRESETS["autumn-gusts"]],
  [800, PRESETS.still],
];
/** Of many sizes, which have clocks of their own, in all directions. */
const places = Array.from({ length: 70 }, (_, k) => ({
  x_m: 5 * (k % 10),
  z_m: 7 * Math.floor(k / 10),
  yaw_rad: 0.7 * k,
  scale: 0.5 + 0.025 * k,
}));

const renderer = new WebGPURenderer();
await renderer.init();
const kinds = await Promise.all(
  ["poplar-forest", "oak"].map(async (name) => ({
    table: readTable(await (await fetch(`/trees/${name}.table`)).arrayBuffer()),
    places,
  })),
);
const wind = PRESETS.breeze;
const usual = createForest({ kinds, wind });
const computed = new ComputedForest(renderer, { kinds, wind });
const report = { steps: STEPS, trees: computed.count, worst: 0, largest: 0, bytesPerTree: computed.bytesPerTree(0) };
for (let step = 1; step <= STEPS; step++) {
  const change = WINDS.find(([at]) => at === step - 1);
  for (const forest of [usual, computed]) {
    if (change) forest.setWind(change[1]);
    forest.step(STEP_S);
  }
  if (step % 50 !== 0) continue;
  await computed.read();
  for (let tree = 0; tree < computed.count; tree++) {
    const { height_m } = kinds[Math.floor(tree / places.length)].table.metadata;
    const [found, wanted] = [computed.coordinates(tree), usual.coordinates(tree)];
    for (let k = 0; k < wanted.length; k++) {
      // A unit of a coordinate moves the farthest vertex by 1 m.
      const apart = Math.abs(found[k] - wanted[k]) / height_m;
      if (!(apart <= report.worst)) report.worst = apart;
      report.largest = Math.max(report.largest, Math.abs(wanted[k]) / height_m);
    }
  }
}
computed.dispose();
const crowd = Array.from({ length: 400_000 }, () => places[0]);
try {
  new ComputedForest(renderer, { kinds: [{ table: kinds[0].table, places: crowd }], wind });
} catch (error) {
  report.refused = `${error}`;
}
window.computed = report;
