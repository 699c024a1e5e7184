/**
 * `<galewood-forest src="trees/poplar" trees="12" wind="breeze">`: a small forest for pages without a build step.
 *
 * - `src`: addresses of trees, separated by spaces; each stands for ADDRESS.table and ADDRESS.glb.
 * - `service`: address of a Galewood service instead, whose trees are planted.
 * - `trees`: their number, 1 to 500 (9).
 * - `wind`: a preset (still, breeze, autumn-gusts, storm-front), or a wind document.
 */
import {
  DirectionalLight,
  HemisphereLight,
  Matrix4,
  Mesh,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  Quaternion,
  Scene,
  ShadowMaterial,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { PRESETS, parseWindText, type WindDocument } from "./core";
import { Forest, servedTrees } from "./three";

const MOST_TREES = 500;
const SPACING_M = 5;
/** Turns each tree on by the golden angle, which also spreads them evenly. */
const TURN_RAD = 2.399963;
const SKYWARD = new Vector3(0, 1, 0);

/** Places on a spiral, each tree turned and sized differently. */
function places(count: number): Matrix4[] {
  return Array.from({ length: count }, (_, k) => {
    const [radius_m, angle_rad] = [SPACING_M * Math.sqrt(k), TURN_RAD * k];
    const spot = new Vector3(radius_m * Math.cos(angle_rad), 0, radius_m * Math.sin(angle_rad));
    const turn = new Quaternion().setFromAxisAngle(SKYWARD, 5 * angle_rad);
    const size = 0.85 + 0.3 * ((0.618034 * k) % 1);
    return new Matrix4().compose(spot, turn, new Vector3(size, size, size));
  });
}

function windOf(text: string | null): WindDocument {
  const name = text ?? "breeze";
  return Object.hasOwn(PRESETS, name) ? PRESETS[name as keyof typeof PRESETS] : parseWindText(name);
}

export class GalewoodForest extends HTMLElement {
  static readonly observedAttributes = ["wind"];
  /** The forest; null while the element is in no document. */
  forest: Forest | null = null;
  /** Ends everything that runs. */
  private end = () => {};

  connectedCallback(): void {
    this.begin().catch((error: unknown) => {
      this.setAttribute("data-error", `${error}`);
      console.error(error);
    });
  }

  disconnectedCallback(): void {
    this.end();
    this.forest = null;
  }

  attributeChangedCallback(_name: string, _before: string | null, wind: string | null): void {
    if (this.forest) this.forest.wind = windOf(wind);
  }

  private async begin(): Promise<void> {
    const renderer = new WebGLRenderer({ antialias: true, alpha: true });
    const camera = new PerspectiveCamera(46, 1, 0.3, 1000);
    const scene = new Scene();
    const forest = new Forest({ wind: windOf(this.getAttribute("wind")) });
    this.forest = forest;
    this.end = () => {
      renderer.setAnimationLoop(null);
      forest.dispose();
      renderer.dispose();
      renderer.domElement.remove();
    };
    const count = Math.min(MOST_TREES, Math.max(1, Number(this.getAttribute("trees") ?? 9) || 1));
    scene.add(...lit(renderer, SPACING_M * Math.sqrt(count)), forest);
    this.show(renderer, camera);
    const height_m = await this.plant(forest, count);
    const far_m = 0.9 * height_m + 1.1 * SPACING_M * Math.sqrt(count);
    camera.position.set(0.3 * far_m, 0.5 * height_m, far_m);
    this.run(renderer, camera, scene, 0.45 * height_m);
  }

  private show(renderer: WebGLRenderer, camera: PerspectiveCamera): void {
    const canvas = renderer.domElement;
    canvas.style.cssText = "display:block;width:100%;height:100%";
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", this.getAttribute("aria-label") ?? "Trees swaying in the wind");
    this.style.display ||= "block";
    this.append(canvas);
    const fit = () => {
      const [width, height] = [Math.max(1, this.clientWidth), Math.max(1, this.clientHeight)];
      renderer.setPixelRatio(Math.min(2, devicePixelRatio));
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    };
    const observer = new ResizeObserver(fit);
    observer.observe(this);
    fit();
    const { end } = this;
    this.end = () => {
      observer.disconnect();
      end();
    };
  }

  /** Plants an equal share of each tree; returns the height of the tallest. */
  private async plant(forest: Forest, count: number): Promise<number> {
    const service = this.getAttribute("service");
    const sources = (this.getAttribute("src") ?? "").split(/\s+/).filter((one) => one !== "");
    const trees = service
      ? await servedTrees(service)
      : sources.map((one) => ({ table: `${one}.table`, mesh: `${one}.glb` }));
    if (trees.length === 0)
      throw new Error("galewood-forest: set src to the address of a tree, without its ending");
    const all = places(count);
    const planted = await Promise.all(
      trees.map((tree, k) =>
        forest.plant(
          tree,
          all.filter((_, i) => i % trees.length === k),
        ),
      ),
    );
    return Math.max(...planted.map(({ height_m }) => height_m));
  }

  private run(renderer: WebGLRenderer, camera: PerspectiveCamera, scene: Scene, target_m: number): void {
    if (!this.forest) return; // removed meanwhile
    const controls = new OrbitControls(camera, renderer.domElement);
    controls.target.set(0, target_m, 0);
    controls.enablePan = false;
    controls.maxPolarAngle = 0.5 * Math.PI;
    const still = matchMedia("(prefers-reduced-motion: reduce)");
    let before_ms = performance.now();
    renderer.setAnimationLoop((now_ms) => {
      controls.update();
      this.forest?.update(still.matches ? 0 : Math.max(0, now_ms - before_ms) / 1000, camera);
      before_ms = now_ms;
      renderer.render(scene, camera);
    });
  }
}

/** Sun, sky and the shadows on the ground of a forest with this radius. */
function lit(renderer: WebGLRenderer, radius_m: number) {
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = PCFShadowMap;
  const sun = new DirectionalLight(0xfff1d6, 3);
  const reach_m = radius_m + 18;
  sun.position.set(0.8 * reach_m, reach_m, 0.7 * reach_m);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  sun.shadow.bias = -0.002;
  Object.assign(sun.shadow.camera, {
    left: -reach_m,
    right: reach_m,
    top: reach_m,
    bottom: -reach_m,
    far: 4 * reach_m,
  });
  const ground = new Mesh(new PlaneGeometry(8 * reach_m, 8 * reach_m), new ShadowMaterial({ opacity: 0.35 }));
  ground.rotation.x = -Math.PI / 2;
  ground.receiveShadow = true;
  return [sun, new HemisphereLight(0xcfe4ff, 0x6d7a4a, 2.2), ground];
}

if (!customElements.get("galewood-forest")) customElements.define("galewood-forest", GalewoodForest);
