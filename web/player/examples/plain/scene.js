import { Forest, PRESETS } from "galewood/three";
import { Matrix4 } from "three";
import { camera, renderer, scene } from "./stage.js";

const forest = new Forest({ wind: PRESETS["autumn-gusts"] });
const places = [-7, 0, 7].map((x) => new Matrix4().makeTranslation(x, 0, -Math.abs(x)));
await forest.plant({ table: "/trees/poplar.table", mesh: "/trees/poplar.glb" }, places);
scene.add(forest);
renderer.setAnimationLoop(() => {
  forest.update(1 / 60, camera);
  renderer.render(scene, camera);
});
