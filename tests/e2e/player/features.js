/** Draws a tree with each kind of material, at various matrices, under three kinds of light, and reports what it found. */
import {
  DirectionalLight,
  Euler,
  Group,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  MeshPhongMaterial,
  MeshPhysicalMaterial,
  MeshToonMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  PointLight,
  Quaternion,
  Raycaster,
  Scene,
  SpotLight,
  Vector3,
  WebGLRenderer,
} from "three";
import { plantInventory, readInventory } from "galewood/inventory";
import { Forest } from "galewood/three";

const renderer = new WebGLRenderer();
renderer.shadowMap.enabled = true;
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
const scene = new Scene();
const camera = new PerspectiveCamera(50, innerWidth / innerHeight, 0.5, 300);
camera.position.set(0, 8, 44);
camera.lookAt(0, 5, 0);
const sun = new DirectionalLight(0xffffff, 2);
sun.position.set(20, 30, 10);
const spot = new SpotLight(0xffffff, 2000);
spot.position.set(-20, 30, 10);
const lamp = new PointLight(0xffffff, 500);
lamp.position.set(0, 20, 8);
for (const light of [sun, spot, lamp]) light.castShadow = true;
for (const light of [sun, spot, lamp]) light.shadow.mapSize.set(256, 256);
const ground = new Mesh(new PlaneGeometry(200, 200), new MeshLambertMaterial({ color: 0x779955 }));
ground.rotation.x = -Math.PI / 2;
ground.receiveShadow = true;
scene.add(sun, spot, lamp, ground);

const kinds = [MeshBasicMaterial, MeshLambertMaterial, MeshPhongMaterial, MeshPhysicalMaterial, MeshToonMaterial];
const frame = new Group();
frame.position.x = -24;
scene.add(frame);
const files = { table: "/trees/poplar-forest.table", mesh: "/trees/poplar-forest.glb" };
const forests = kinds.map((Kind) => {
  const materials = (part, { map }) => new Kind({ map, alphaTest: part === "leaves" ? 0.4 : 0, side: 2 });
  return new Forest({ wind: () => ({ x: 9, z: 0 }), materials });
});
/** Upright, turned, tilted, of two sizes, and in a frame that is moved. */
const matrixOf = (k) =>
  new Matrix4().compose(
    new Vector3(12 * k, 0, 0),
    new Quaternion().setFromEuler(new Euler(0, k, k === 2 ? 0.4 : 0, "XYZ")),
    new Vector3(0.7, k === 3 ? 0.5 : 0.7, 0.7),
  );
const planted = await Promise.all(forests.map((forest, k) => forest.plant(files, [matrixOf(k)])));
frame.add(...forests);
frame.updateMatrixWorld();
const before = planted[0].tip(0, new Vector3());
const pair = await forests[2].plant(files, [matrixOf(9), matrixOf(9), matrixOf(9)]);
// Beyond the picture.
const stem = (east_m, species, height_m) => ({ east_m, north_m: 0, species, builtin: "poplar", height_m, slender: false });
const stems = readInventory({ version: 1, stems: [stem(-300, "poplar", 12), stem(300, "aspen", 6)] });
const stand = await plantInventory(forests[1], stems, { poplar: files });
const stand_m = [0, 1].map((tree) => stand.poplar.tip(tree, new Vector3()).y); // at rest
const refused = await forests[0]
  .plant({ table: files.table, mesh: "/trees/poplar.glb" }, [new Matrix4()])
  .then(() => "", String);

const ray = (x, y) => {
  const raycaster = new Raycaster();
  raycaster.setFromCamera(new Vector3(x, y, 20).project(camera), camera);
  raycaster.set(new Vector3(x, y, 60), new Vector3(0, 0, -1));
  return raycaster;
};

function report() {
  const picked = forests.flatMap((forest, k) => {
    const tip = planted[k].tip(0, new Vector3());
    const foot = new Vector3().setFromMatrixPosition(matrixOf(k)).applyMatrix4(frame.matrixWorld);
    const middle = foot.lerp(tip, 0.5);
    return forest.pick(ray(middle.x, middle.y))?.trees === planted[k] ? [k] : [];
  });
  forests[2].uproot(planted[2]);
  forests[2].move(pair, [matrixOf(20), matrixOf(21), matrixOf(2)]);
  forests[2].update(0, camera);
  const tip = pair.tip(2, new Vector3());
  const [hit] = ray(0.5 * tip.x, 0.5 * tip.y).intersectObject(forests[2]);
  window.features = {
    picked,
    instance: hit?.instanceId ?? null,
    beside: forests[0].pick(ray(60, 30)) !== null,
    tip_m: planted[0].tip(0, new Vector3()).sub(before).toArray(),
    stand_m,
    refused,
    time_s: forests[0].time_s,
  };
}

renderer.setAnimationLoop(() => {
  for (const forest of forests) forest.update(1 / 30, camera);
  renderer.render(scene, camera);
  if (window.features || !forests.every(({ time_s }) => time_s > 1)) return;
  renderer.setAnimationLoop(null);
  report();
});
