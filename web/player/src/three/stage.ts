/** What small forests are shown on, in an element of a page or below the cell of a notebook. */
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
import type { BaseForest } from "./baseForest";

const SPACING_M = 5;
/** Turns each tree on by the golden angle, which also spreads them evenly. */
const TURN_RAD = 2.399963;
const SKY_DIRECTION = new Vector3(0, 1, 0);

/** Places on a spiral, each tree turned and sized differently. */
export function places(count: number): Matrix4[] {
  return Array.from({ length: count }, (_, k) => {
    const [radius_m, angle_rad] = [SPACING_M * Math.sqrt(k), TURN_RAD * k];
    const spot = new Vector3(radius_m * Math.cos(angle_rad), 0, radius_m * Math.sin(angle_rad));
    const turn = new Quaternion().setFromAxisAngle(SKY_DIRECTION, 5 * angle_rad);
    const size = 0.85 + 0.3 * ((0.618034 * k) % 1);
    return new Matrix4().compose(spot, turn, new Vector3(size, size, size));
  });
}

/** WebGLRenderer or WebGPURenderer. */
export interface StageRenderer
  extends Pick<WebGLRenderer, "domElement" | "render" | "setPixelRatio" | "setSize" | "dispose"> {
  readonly shadowMap: Pick<WebGLRenderer["shadowMap"], "enabled" | "type">;
  setAnimationLoop(callback: ((time_ms: number) => void) | null): unknown;
  forceContextLoss?(): void;
}

export const RENDERER_OPTIONS = { antialias: true, alpha: true };

/** The error of a renderer that cannot start. */
export const noGraphics = (cause: unknown) =>
  new Error("this browser does not show 3D graphics: WebGL 2 is switched off or missing", { cause });

export function startWebgl(): WebGLRenderer {
  try {
    return new WebGLRenderer(RENDERER_OPTIONS);
  } catch (cause) {
    throw noGraphics(cause);
  }
}

/** A picture that fills an element, with sun, sky and ground for so many trees at `places`. Disposes of its renderer and forest. */
export class Stage {
  private readonly camera = new PerspectiveCamera(46, 1, 0.3, 1000);
  private readonly scene = new Scene();
  private readonly observer: ResizeObserver;
  private readonly radius_m: number;
  private ended = false;

  constructor(
    private readonly host: HTMLElement,
    private readonly forest: BaseForest,
    private readonly renderer: StageRenderer,
    trees: number,
  ) {
    this.radius_m = SPACING_M * Math.sqrt(trees);
    this.scene.add(...lit(this.renderer, this.radius_m), forest);
    const canvas = this.renderer.domElement;
    canvas.style.cssText = "display:block;width:100%;height:100%";
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", host.getAttribute("aria-label") ?? "Trees swaying in the wind");
    host.append(canvas);
    this.observer = new ResizeObserver(() => this.fit());
    this.observer.observe(host);
    this.fit();
  }

  /** Shows the trees, whose tallest has this height, until the end. */
  run(height_m: number): void {
    if (this.ended) return; // while they were loaded
    const { camera, renderer, forest, scene } = this;
    const far_m = 1.4 * height_m + this.radius_m; // the trees in front are seen as a whole
    camera.position.set(0.3 * far_m, 0.5 * height_m, far_m);
    const controls = new OrbitControls(camera, renderer.domElement);
    controls.target.set(0, 0.5 * height_m, 0);
    controls.enablePan = false;
    controls.maxPolarAngle = 0.5 * Math.PI;
    const still = matchMedia("(prefers-reduced-motion: reduce)");
    let before_ms = performance.now();
    renderer.setAnimationLoop((now_ms) => {
      controls.update();
      forest.update(still.matches ? 0 : Math.max(0, now_ms - before_ms) / 1000, camera);
      before_ms = now_ms;
      renderer.render(scene, camera);
    });
  }

  /** Ends everything that runs, the forest's worker too, and removes the picture. */
  end(): void {
    this.ended = true;
    this.observer.disconnect();
    this.renderer.setAnimationLoop(null);
    this.forest.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss?.(); // browsers allow few contexts, and free them late
    this.renderer.domElement.remove();
  }

  private fit(): void {
    const { host, renderer, camera } = this;
    const [width, height] = [Math.max(1, host.clientWidth), Math.max(1, host.clientHeight)];
    renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
  }
}

/** Sun, sky and the shadows on the ground of a forest with this radius. */
function lit(renderer: StageRenderer, radius_m: number) {
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
