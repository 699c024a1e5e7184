/** Plants a built-in tree, whose pictures are inside of its GLB, and another, whose pictures are files; says what was found. */
import { DirectionalLight, HemisphereLight, Matrix4, PerspectiveCamera, Scene, WebGLRenderer, WebGLRenderTarget } from "three";
import { Forest, PRESETS } from "galewood/three";

const SIDE_PX = 128;

/** How many pixels are drawn, and how many of them are as green as leaves; trees without pictures are white. */
function colours(renderer, scene, camera) {
  const target = new WebGLRenderTarget(SIDE_PX, SIDE_PX);
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const texels = new Uint8Array(4 * SIDE_PX * SIDE_PX);
  renderer.readRenderTargetPixels(target, 0, 0, SIDE_PX, SIDE_PX, texels);
  renderer.setRenderTarget(null);
  const found = { drawn: 0, green: 0 };
  for (let k = 0; k < texels.length; k += 4) {
    if (texels[k + 3] === 0) continue;
    found.drawn++;
    if (texels[k + 1] > 1.3 * texels[k + 2] + 2) found.green++;
  }
  return found;
}

async function shown(mesh) {
  const forest = new Forest({ wind: PRESETS.breeze });
  await forest.plant({ table: "/trees/apricot-forest.table", mesh }, [new Matrix4()]);
  const scene = new Scene();
  scene.add(forest, new HemisphereLight(0xffffff, 0xffffff, 2), new DirectionalLight(0xffffff, 1));
  const camera = new PerspectiveCamera(40, 1, 0.1, 100);
  camera.position.set(0, 6, 22);
  camera.lookAt(0, 6, 0);
  const renderer = new WebGLRenderer({ alpha: true });
  forest.update(1 / 60, camera);
  const found = colours(renderer, scene, camera);
  forest.dispose();
  return found;
}

try {
  globalThis.found = [await shown("/trees/apricot-forest.glb"), await shown("/light/apricot-forest.glb")];
} catch (error) {
  globalThis.found = `${error}`;
}
