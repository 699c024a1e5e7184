/**
 * The same trees in the same wind for everyone who opens this page: `?service=https://forest.example&share=park`. The service
 * computes the motion. Everyone can change the wind.
 */
import { streamed } from "galewood/stream";
import { Forest, PRESETS, servedTrees } from "galewood/three";
import { Matrix4 } from "three";
import { camera, renderer, scene } from "../plain/stage.js";

const asked = new URLSearchParams(location.search);
const service = asked.get("service") ?? location.origin;
const share = asked.get("share") ?? "galewood-example";
const select = document.querySelector("select");
const output = document.querySelector("output");

const worker = streamed({
  service,
  share,
  onPresent: (clients) => {
    output.value = clients > 1 ? `${clients} are here` : "alone";
  },
  onWind: ({ model }) => {
    select.value = Object.keys(PRESETS).find((name) => PRESETS[name].model === model) ?? select.value;
  },
});
const forest = new Forest({ wind: PRESETS.breeze, worker });
scene.add(forest);

const [tree] = await servedTrees(service);
await forest.plant(
  tree,
  [-7, 0, 7].map((x) => new Matrix4().makeTranslation(x, 0, -Math.abs(x))),
);

select.addEventListener("change", () => {
  forest.wind = PRESETS[select.value];
});
let before_ms = null;
renderer.setAnimationLoop((now_ms) => {
  // not performance.now(): the first frame may have begun before this line ran
  forest.update((now_ms - (before_ms ?? now_ms)) / 1000, camera);
  before_ms = now_ms;
  renderer.render(scene, camera);
});
