// A page that draws an exported tree in three.js: a GLB with an animation, or vertex animation textures. window.draw(file, time_s).
import {
  AnimationMixer,
  Box3,
  Color,
  DirectionalLight,
  HemisphereLight,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const renderer = new WebGLRenderer({ canvas: document.querySelector("canvas"), antialias: true, preserveDrawingBuffer: true });
const scene = new Scene();
scene.background = new Color(0xbcd6ea);
scene.add(new HemisphereLight(0xffffff, 0x8a9070, 2.2));
const sun = new DirectionalLight(0xffffff, 2.5);
sun.position.set(1, 2, 1);
scene.add(sun);

async function load(file, time_s) {
  if (file.endsWith(".json")) {
    const { loadVat } = await import(/* @vite-ignore */ "/galewoodVat.js");
    const tree = await loadVat(file);
    tree.time.value = time_s;
    return tree.object;
  }
  const { scene: tree, animations } = await new GLTFLoader().loadAsync(file);
  const mixer = new AnimationMixer(tree);
  for (const clip of animations) mixer.clipAction(clip).play();
  mixer.setTime(time_s);
  return tree;
}

window.draw = async (file, time_s, height_m) => {
  const tree = await load(file, time_s);
  scene.add(tree);
  const { width, height } = renderer.domElement;
  const camera = new PerspectiveCamera(30, width / height, 0.1, 1000);
  camera.position.set(0, 0.47 * height_m, 2.2 * height_m);
  camera.lookAt(new Vector3(0, 0.47 * height_m, 0));
  renderer.render(scene, camera);
  return new Box3().setFromObject(tree).getSize(new Vector3()).toArray();
};
window.ready = true;
