/**
 * Plays an exported GLB in Babylon.js without a browser: node babylonLive.mjs FILE.glb REQUEST.json
 *
 * The request holds `frame_s`, `winds` ([x, z] of every frame, m/s; none: the wind of the file), `frames`, and `vertices` of the
 * first mesh whose places are wanted, with `tracked` at every frame. Prints the weights of every frame by mesh, these places (at the
 * last frame, or `track` of all), and the time taken.
 */
import { readFileSync } from "node:fs";
import { NullEngine } from "@babylonjs/core/Engines/nullEngine.js";
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { LoadAssetContainerAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { Vector2, Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { Scene } from "@babylonjs/core/scene.js";
import { GetKHRInteractivityImportResult } from "@babylonjs/loaders/glTF/2.0/Extensions/KHR_interactivity.js";
import "@babylonjs/loaders/glTF/2.0/index.js";

const [file, request] = process.argv.slice(2);
const { frame_s, frames, winds, vertices, event, tracked } = JSON.parse(readFileSync(request, "utf8"));

const engine = new NullEngine({ renderWidth: 64, renderHeight: 64, textureSize: 64, deterministicLockstep: false });
engine.getDeltaTime = () => 1000 * frame_s;
const scene = new Scene(engine);
scene.useRightHandedSystem = true;
new FreeCamera("camera", new Vector3(0, 5, 20), scene);
const container = await LoadAssetContainerAsync(readFileSync(file), scene, { pluginExtension: ".glb" });
container.addAllToScene();
const { diagnostics, flowGraph, coordinator } = GetKHRInteractivityImportResult(scene).graphs[0];
if (diagnostics.length > 0 || !flowGraph) throw new Error(JSON.stringify(diagnostics));
const context = flowGraph.getContext(0);
const meshes = container.meshes.filter((mesh) => mesh.morphTargetManager);
const weightsOf = ({ morphTargetManager }) =>
  Array.from({ length: morphTargetManager.numTargets }, (_, k) => morphTargetManager.getTarget(k).influence);

const [mesh] = meshes;
const placesNow = () => {
  const places = mesh.getPositionData(false, true);
  return vertices.map((vertex) => Array.from(places.slice(3 * vertex, 3 * vertex + 3)));
};

const told = [];
const track = [];
const begin_ms = performance.now();
for (let frame = 0; frame < frames; frame++) {
  if (winds && event) {
    coordinator.notifyCustomEvent(event, { x_m_s: winds[frame][0], z_m_s: winds[frame][1], gustiness: 0 });
  } else if (winds) {
    context.setVariable("staticVariable_0", new Vector2(...winds[frame]));
    context.setVariable("staticVariable_1", 0);
  }
  scene.render();
  told.push(meshes.map(weightsOf));
  if (tracked) track.push(placesNow());
}
const milliseconds = performance.now() - begin_ms;
console.log(
  JSON.stringify({
    playing: container.animationGroups.filter((group) => group.isPlaying).length,
    weights: told,
    places: placesNow(),
    track,
    milliseconds,
  }),
);
engine.dispose();
