/** Three poplars, one of them in materials of nodes (TSL). */
import { Forest, PRESETS } from "galewood/webgpu";
import { Matrix4 } from "three";
import { color, mix, positionWorld, texture, vec4 } from "three/tsl";
import { DoubleSide, MeshStandardNodeMaterial } from "three/webgpu";
import { camera, renderer, scene } from "./stage.js";

const files = { table: "/trees/poplar.table", mesh: "/trees/poplar.glb" };
const placesAt = (...xs) => xs.map((x) => new Matrix4().makeTranslation(x, 0, -Math.abs(x)));

/** Leaves that turn red towards the top. */
function reddening(part, { map }) {
  const material = new MeshStandardNodeMaterial({ map, roughness: 1 });
  if (part === "wood") return material;
  const leaf = texture(map);
  const red = color(0xc03018).mul(leaf.g.mul(2));
  material.colorNode = vec4(mix(leaf.rgb, red, positionWorld.y.div(14).clamp(0, 1)), leaf.a);
  material.alphaTest = 0.42;
  material.side = DoubleSide;
  return material;
}

const wind = PRESETS["autumn-gusts"];
const [plain, red] = [new Forest({ wind }), new Forest({ wind, materials: reddening })];
await Promise.all([plain.plant(files, placesAt(-7, 7)), red.plant(files, placesAt(0))]);
scene.add(plain, red);
await renderer.init();
renderer.setAnimationLoop(() => {
  for (const forest of [plain, red]) forest.update(1 / 60, camera);
  renderer.render(scene, camera);
});
