/**
 * Three trees in Babylon.js. `galewood/core` steps them and computes their vertices on the processor, which is enough for a few
 * trees; their normals stay those at rest. For many, move the vertices in a shader by `forest.nodes()` and `jointsOf()`.
 */
import "@babylonjs/core/Lights/Shadows/shadowGeneratorSceneComponent.js";
import { VertexBuffer } from "@babylonjs/core/Buffers/buffer.js";
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { DirectionalLight } from "@babylonjs/core/Lights/directionalLight.js";
import { HemisphericLight } from "@babylonjs/core/Lights/hemisphericLight.js";
import { ShadowGenerator } from "@babylonjs/core/Lights/Shadows/shadowGenerator.js";
import { LoadAssetContainerAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { StandardMaterial } from "@babylonjs/core/Materials/standardMaterial.js";
import { Color3, Color4 } from "@babylonjs/core/Maths/math.color.js";
import { Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { CreateGround } from "@babylonjs/core/Meshes/Builders/groundBuilder.js";
import { Scene } from "@babylonjs/core/scene.js";
import { RegisterGLTF2Loader } from "@babylonjs/loaders/glTF/2.0/glTFLoader.pure.js";
import { RegisterGLTFFileLoader } from "@babylonjs/loaders/glTF/glTFFileLoader.pure.js";
import { createForest, PRESETS, readTable } from "galewood/core";

RegisterGLTF2Loader();
RegisterGLTFFileLoader();

const PLACES = [-6, 0, 6].map((x_m, k) => ({ x_m, z_m: -Math.abs(x_m), yaw_rad: k, scale: 1 - 0.1 * k }));

const engine = new Engine(document.querySelector("canvas"), true);
const scene = new Scene(engine);
scene.useRightHandedSystem = true; // as in glTF and in the tables
scene.clearColor = new Color4(0.74, 0.84, 0.92, 1);
const camera = new FreeCamera("camera", new Vector3(3, 5, 25), scene);
camera.setTarget(new Vector3(0, 6.2, 0));
new HemisphericLight("sky", new Vector3(0, 1, 0), scene).intensity = 0.8;
const sun = new DirectionalLight("sun", new Vector3(-14, -22, -12), scene);
sun.position = new Vector3(28, 44, 24);
sun.intensity = 1.8;
const shadows = new ShadowGenerator(1024, sun);
const meadow = CreateGround("meadow", { width: 400, height: 400 }, scene);
meadow.material = Object.assign(new StandardMaterial("grass", scene), {
  diffuseColor: new Color3(0.24, 0.31, 0.14),
  specularColor: Color3.Black(),
});
meadow.receiveShadows = true;

const table = readTable(await (await fetch("/trees/poplar.table")).arrayBuffer());
const forest = createForest({ kinds: [{ table, places: PLACES }], wind: PRESETS["autumn-gusts"] });
const { meshes } = await LoadAssetContainerAsync("/trees/poplar.glb", scene, { pluginExtension: ".glb" });
/** The meshes of all trees: where their vertices rest and are, and the number of the first in the table. */
const moving = [];
let first = 0;
for (const { name, vertices } of table.metadata.primitives) {
  const mesh = meshes.find((one) => one.name === name);
  mesh.material.twoSidedLighting = false; // normals of leaves are those of the crown
  const rest_m = Float32Array.from(mesh.getVerticesData(VertexBuffer.PositionKind));
  for (const [tree, { x_m, z_m, yaw_rad, scale }] of PLACES.entries()) {
    const own = mesh.clone(`${name} of tree ${tree}`, null);
    own.makeGeometryUnique();
    own.setVerticesData(VertexBuffer.PositionKind, rest_m, true);
    own.position.set(x_m, 0, z_m);
    own.rotationQuaternion = null;
    own.rotation.set(0, yaw_rad, 0);
    own.scaling.setAll(scale);
    own.alwaysSelectAsActiveMesh = true; // its bounds are those of the tree at rest
    own.receiveShadows = true;
    scene.addMesh(own);
    shadows.addShadowCaster(own);
    moving.push({ own, tree, first, rest_m, now_m: new Float32Array(rest_m.length) });
  }
  first += vertices;
}

engine.runRenderLoop(() => {
  forest.step(Math.min(0.1, engine.getDeltaTime() / 1000));
  for (const { own, tree, first, rest_m, now_m } of moving) {
    own.updateVerticesData(VertexBuffer.PositionKind, forest.vertices(tree, rest_m, now_m, first));
  }
  scene.render();
});
addEventListener("resize", () => engine.resize());
