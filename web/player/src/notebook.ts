/** The front end of a notebook's widget (anywidget): a small forest below a cell. Everything it needs is in its one file. */

import workerSource from "virtual:worker";
import { DirectionalLight, HemisphereLight, Matrix4, PerspectiveCamera, Scene, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { PRESETS, parseWindText } from "./core/wind/wind";
import { Forest } from "./three/forest";

/** The part of anywidget's model that is needed. */
interface Model {
  get(name: "table" | "mesh"): DataView;
  get(name: "trees" | "height_px"): number;
  get(name: "wind"): string;
  on(event: string, listener: () => void): void;
}

const SPACING_M = 5;
const TURN_RAD = 2.399963;

const bytesOf = ({ buffer, byteOffset, byteLength }: DataView): ArrayBuffer =>
  (buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength);

/** A front end may run where no further file can be fetched. */
function startWorker(): Worker {
  const url = URL.createObjectURL(new Blob([workerSource], { type: "text/javascript" }));
  return new Worker(url, { type: "module" });
}

const places = (count: number): Matrix4[] =>
  Array.from({ length: count }, (_, k) =>
    new Matrix4()
      .makeTranslation(
        SPACING_M * Math.sqrt(k) * Math.cos(TURN_RAD * k),
        0,
        SPACING_M * Math.sqrt(k) * Math.sin(TURN_RAD * k),
      )
      .multiply(new Matrix4().makeRotationY(5 * k)),
  );

const windOf = (text: string) =>
  Object.hasOwn(PRESETS, text) ? PRESETS[text as keyof typeof PRESETS] : parseWindText(text);

/** Shows the forest; returns what ends it. */
async function render({ model, el }: { model: Model; el: HTMLElement }): Promise<() => void> {
  const renderer = new WebGLRenderer({ antialias: true, alpha: true });
  const height = model.get("height_px");
  const width = Math.max(200, el.clientWidth);
  renderer.setSize(width, height);
  renderer.domElement.setAttribute("role", "img");
  renderer.domElement.setAttribute("aria-label", "Trees swaying in the wind");
  el.append(renderer.domElement);
  const forest = new Forest({ wind: windOf(model.get("wind")), worker: startWorker });
  model.on("change:wind", () => {
    forest.wind = windOf(model.get("wind"));
  });
  const sun = new DirectionalLight(0xfff1d6, 3);
  sun.position.set(14, 22, 12);
  const scene = new Scene();
  scene.add(forest, sun, new HemisphereLight(0xcfe4ff, 0x6d7a4a, 2.2));
  const count = model.get("trees");
  const files = { table: bytesOf(model.get("table")), mesh: bytesOf(model.get("mesh")) };
  const { height_m } = await forest.plant(files, places(count));
  const camera = new PerspectiveCamera(46, width / height, 0.3, 1000);
  camera.position.set(4, 0.5 * height_m, 0.9 * height_m + SPACING_M * Math.sqrt(count));
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.set(0, 0.45 * height_m, 0);
  let before_ms = performance.now();
  renderer.setAnimationLoop((now_ms) => {
    controls.update();
    forest.update(Math.max(0, now_ms - before_ms) / 1000, camera);
    before_ms = now_ms;
    renderer.render(scene, camera);
  });
  return () => {
    renderer.setAnimationLoop(null);
    forest.dispose();
    renderer.dispose();
  };
}

export default { render };
