// A live GLB in Babylon.js, in a browser: window.play(frames, wind) draws frames of 1/30 s in a wind (x, z), m/s.
import "@babylonjs/core/Materials/Textures/Loaders/index.js";
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { DirectionalLight } from "@babylonjs/core/Lights/directionalLight.js";
import { HemisphericLight } from "@babylonjs/core/Lights/hemisphericLight.js";
import { LoadAssetContainerAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { Color4 } from "@babylonjs/core/Maths/math.color.js";
import { Vector2, Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { Scene } from "@babylonjs/core/scene.js";
import { GetKHRInteractivityImportResult } from "@babylonjs/loaders/glTF/2.0/Extensions/KHR_interactivity.js";
import "@babylonjs/loaders/glTF/2.0/index.js";

const engine = new Engine(document.querySelector("canvas"), true, { preserveDrawingBuffer: true });
engine.getDeltaTime = () => 1000 / 30;
const scene = new Scene(engine);
scene.useRightHandedSystem = true; // as in glTF
scene.clearColor = new Color4(0.74, 0.84, 0.92, 1);
new HemisphericLight("sky", new Vector3(0, 1, 0), scene).intensity = 0.9;
new DirectionalLight("sun", new Vector3(-1, -2, -1), scene).intensity = 2;
const bytes = new Uint8Array(await (await fetch("/tree.glb")).arrayBuffer());
const tree = await LoadAssetContainerAsync(bytes, scene, { pluginExtension: ".glb" });
tree.addAllToScene();
const { height_m } = await (await fetch("/tree.json")).json();
const camera = new FreeCamera("camera", new Vector3(0, 0.47 * height_m, 1.8 * height_m), scene);
camera.setTarget(new Vector3(0, 0.47 * height_m, 0));
const context = GetKHRInteractivityImportResult(scene).graphs[0].flowGraph.getContext(0);
const mesh = tree.meshes.find((one) => one.morphTargetManager);

window.play = (frames, wind) => {
  context.setVariable("staticVariable_0", new Vector2(...wind));
  context.setVariable("staticVariable_1", 0);
  for (let frame = 0; frame < frames; frame++) scene.render();
  return mesh.morphTargetManager.getTarget(0).influence;
};
await scene.whenReadyAsync();
window.ready = true;
