// Reads exported GLBs with three.js: node read_in_three.mjs CLIP TIME_S LEVEL_0.glb LEVEL_1.glb …
// Prints of each file, in which the clip of the first plays: names, and where the skinned vertices are.
import { readFileSync } from "node:fs";
import { AnimationMixer, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

globalThis.self = globalThis;
globalThis.createImageBitmap = async () => ({ width: 4, height: 4, close() {} });

const [clipName, time_s, ...files] = process.argv.slice(2);
const read = await Promise.all(
  files.map((file) => new GLTFLoader().parseAsync(new Uint8Array(readFileSync(file)).buffer, "")),
);
const clips = read[0].animations;
const clip = clips.find(({ name }) => name === clipName);
for (const { scene } of read) {
  const mixer = new AnimationMixer(scene);
  mixer.clipAction(clip).play();
  mixer.setTime(Number(time_s));
  scene.updateMatrixWorld(true);
  const meshes = [];
  let capsule = null;
  scene.traverse((object) => {
    if (object.userData.galewood_collision) {
      const up = new Vector3(0, 1, 0).applyQuaternion(object.quaternion).toArray();
      capsule = { name: object.name, middle: object.position.toArray(), up, ...object.userData.galewood_collision };
    }
    if (!object.isSkinnedMesh) return;
    const { position, tangent } = object.geometry.attributes;
    const moved = Array.from({ length: position.count }, (_, v) => object.getVertexPosition(v, new Vector3()).toArray());
    const rest = Array.from({ length: position.count }, (_, v) => new Vector3().fromBufferAttribute(position, v).toArray());
    meshes.push({ name: object.name, moved, rest, tangents: tangent?.count ?? 0 });
  });
  console.log(JSON.stringify({ clips: clips.map(({ name }) => name), meshes, capsule }));
}
