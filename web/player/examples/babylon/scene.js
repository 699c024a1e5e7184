/** Three trees in Babylon.js. `galewood/core` steps them; a plugin of the material moves their vertices by their nodes. */
import "@babylonjs/core/Lights/Shadows/shadowGeneratorSceneComponent.js";
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { Constants } from "@babylonjs/core/Engines/constants.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { DirectionalLight } from "@babylonjs/core/Lights/directionalLight.js";
import { HemisphericLight } from "@babylonjs/core/Lights/hemisphericLight.js";
import { ShadowGenerator } from "@babylonjs/core/Lights/Shadows/shadowGenerator.js";
import { LoadAssetContainerAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { StandardMaterial } from "@babylonjs/core/Materials/standardMaterial.js";
import { RawTexture } from "@babylonjs/core/Materials/Textures/rawTexture.js";
import { Color3, Color4 } from "@babylonjs/core/Maths/math.color.js";
import { Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { CreateGround } from "@babylonjs/core/Meshes/Builders/groundBuilder.js";
import { Scene } from "@babylonjs/core/scene.js";
import { RegisterGLTF2Loader } from "@babylonjs/loaders/glTF/2.0/glTFLoader.pure.js";
import { RegisterGLTFFileLoader } from "@babylonjs/loaders/glTF/glTFFileLoader.pure.js";
import { createForest, jointsOf, PRESETS, readTable } from "galewood/core";
import { SwayPlugin } from "./swayPlugin.js";

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
const { nodes, jointNodes, jointShare, jointRest_m, vertexJoint } = jointsOf(table);

/** Two texels per node and a row per tree. */
const data = new Float32Array(4 * 2 * nodes * PLACES.length);
const texture = RawTexture.CreateRGBATexture(
  data,
  2 * nodes,
  PLACES.length,
  scene,
  false,
  false,
  Constants.TEXTURE_NEAREST_SAMPLINGMODE,
  Constants.TEXTURETYPE_FLOAT,
);

/** Adds to a mesh how its vertices are held; the first is number `first` of the table. */
function hold(mesh, first) {
  const count = mesh.getTotalVertices();
  const joints = new Float32Array(4 * count);
  const pivots = new Float32Array(3 * count);
  for (let v = 0; v < count; v++) {
    const joint = vertexJoint[first + v];
    joints.set([jointNodes[2 * joint], jointNodes[2 * joint + 1], jointShare[joint]], 4 * v);
    pivots.set(jointRest_m.subarray(3 * joint, 3 * joint + 3), 3 * v);
  }
  mesh.setVerticesData("joint", joints, false, 4);
  mesh.setVerticesData("pivot", pivots, false, 3);
}

const { meshes } = await LoadAssetContainerAsync("/trees/poplar.glb", scene, { pluginExtension: ".glb" });
let first = 0;
for (const { name, vertices } of table.metadata.primitives) {
  const mesh = meshes.find((one) => one.name === name);
  hold(mesh, first);
  first += vertices;
  mesh.material.twoSidedLighting = false; // normals of leaves are those of the crown
  new SwayPlugin(mesh.material, texture);
  for (const [tree, { x_m, z_m, yaw_rad, scale }] of PLACES.entries()) {
    const own = mesh.clone(`${name} of tree ${tree}`, null);
    own.metadata = { tree };
    own.position.set(x_m, 0, z_m);
    own.rotationQuaternion = null;
    own.rotation.set(0, yaw_rad, 0);
    own.scaling.setAll(scale);
    own.alwaysSelectAsActiveMesh = true; // its bounds are those of the tree at rest
    own.receiveShadows = true;
    scene.addMesh(own);
    shadows.addShadowCaster(own);
  }
}

function takeNodes() {
  for (const tree of PLACES.keys()) {
    const { displacement_m, rotation } = forest.nodes(tree);
    for (let node = 0, to = 8 * nodes * tree; node < nodes; node++, to += 8) {
      data.set(displacement_m.subarray(3 * node, 3 * node + 3), to);
      data.set(rotation.subarray(3 * node, 3 * node + 3), to + 4);
    }
  }
  texture.update(data);
}

engine.runRenderLoop(() => {
  forest.step(Math.min(0.1, engine.getDeltaTime() / 1000));
  takeNodes();
  scene.render();
});
addEventListener("resize", () => engine.resize());
