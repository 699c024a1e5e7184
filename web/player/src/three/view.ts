/** What of a forest is drawn: from the camera, and from the lights that cast shadows. */
import {
  type Camera,
  type DirectionalLight,
  Frustum,
  type Light,
  Matrix4,
  type Object3D,
  type PerspectiveCamera,
  Vector3,
} from "three";
import type { View } from "../trees/drawList";

/** The distances of the level of detail are meant for this vertical field of view, rad. */
const FIELD_RAD = 0.8;
/** Lights are looked for again after this many frames. */
const LIGHTS_EVERY = 60;

export interface ViewOptions {
  /** Distances (m) up to which a tree of scale 1 shows all its leaves and branches, and at which it shows a fifth. */
  detail_m: readonly [number, number];
  /** Trees farther away cast no shadows. */
  shadow_m: number;
}

/** The directions of the lights that cast shadows; null while any of them has none. */
function lightsIn(scene: Object3D): DirectionalLight | "many" | null {
  let found: DirectionalLight | "many" | null = null;
  scene.traverseVisible((object) => {
    const light = object as Light;
    if (!light.isLight || !light.castShadow) return;
    found =
      found === null && (light as DirectionalLight).isDirectionalLight ? (light as DirectionalLight) : "many";
  });
  return found;
}

export class Viewer {
  private readonly frustum = new Frustum();
  private readonly clip = new Matrix4();
  private readonly seen = new Matrix4();
  private readonly inverse = new Matrix4();
  private readonly eye = new Vector3();
  private readonly sun = new Vector3();
  private readonly target = new Vector3();
  private readonly seenSun = new Vector3();
  private lights: ReturnType<typeof lightsIn> = null;
  private age = LIGHTS_EVERY;
  private seenDetail = "";

  /** Takes the camera and the lights; returns whether the view of the forest has changed. */
  look(camera: Camera, forest: Object3D, options: ViewOptions): boolean {
    camera.updateWorldMatrix(true, false);
    this.clip.multiplyMatrices(camera.projectionMatrix, this.inverse.copy(camera.matrixWorld).invert());
    this.clip.multiply(forest.matrixWorld);
    this.inverse.copy(forest.matrixWorld).invert();
    this.eye.setFromMatrixPosition(camera.matrixWorld).applyMatrix4(this.inverse);
    this.findLights(forest);
    const detail = `${options.detail_m},${options.shadow_m},${this.lights === "many"}`;
    const same = this.clip.equals(this.seen) && this.sun.distanceTo(this.seenSun) < 1e-3;
    if (same && detail === this.seenDetail) return false;
    this.seen.copy(this.clip);
    this.seenSun.copy(this.sun);
    this.seenDetail = detail;
    return true;
  }

  private findLights(forest: Object3D): void {
    if (this.age++ >= LIGHTS_EVERY) {
      this.age = 0;
      let root = forest;
      while (root.parent) root = root.parent;
      this.lights = lightsIn(root);
    }
    if (this.lights === null || this.lights === "many") return;
    this.target.setFromMatrixPosition(this.lights.target.matrixWorld);
    this.sun.setFromMatrixPosition(this.lights.matrixWorld).sub(this.target);
    this.sun.transformDirection(this.inverse);
  }

  /** The view that was taken last. */
  view(camera: Camera, { detail_m, shadow_m }: ViewOptions): View {
    const { fov, zoom } = camera as PerspectiveCamera;
    const wide = fov === undefined ? 0 : Math.tan((fov * Math.PI) / 360) / (zoom * Math.tan(FIELD_RAD / 2));
    const farther = wide > 0 ? 1 / wide : Number.POSITIVE_INFINITY; // parallel projections show everything
    return {
      planes: this.frustum.setFromProjectionMatrix(this.clip, camera.coordinateSystem, camera.reversedDepth)
        .planes,
      eye: this.eye,
      sun: this.sun,
      levelFrom_m: [detail_m[0] * farther, detail_m[1] * farther],
      shadow_m: this.lights === null ? 0 : shadow_m,
      allCast: this.lights === "many",
    };
  }
}
