/** A small scene for one tree: light, ground and an orbiting camera. */
import {
  AmbientLight,
  CircleGeometry,
  Color,
  DirectionalLight,
  Mesh,
  MeshBasicMaterial,
  MOUSE,
  type Object3D,
  PerspectiveCamera,
  type Raycaster,
  Scene,
  TOUCH,
  type Vector2,
  WebGLRenderer,
  type WebGLRenderTarget,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const BACKGROUND_COLOUR = 0x141c21;
const GROUND_COLOUR = 0x26302a;

export class PreviewStage {
  readonly scene = new Scene();
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(34, 1, 0.05, 400);
  private readonly controls: OrbitControls;
  private readonly ground = new Mesh(
    new CircleGeometry(1, 64),
    new MeshBasicMaterial({ color: GROUND_COLOUR }),
  );
  private readonly resized: ResizeObserver;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.scene.background = new Color(BACKGROUND_COLOUR);
    const sun = new DirectionalLight(0xfff0d8, 2.6);
    sun.position.set(3, 5, 2);
    this.ground.rotation.x = -Math.PI / 2;
    this.scene.add(new AmbientLight(0xbfd0dd, 1.1), sun, this.ground);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.resized = new ResizeObserver(() => this.resize(canvas));
    this.resized.observe(canvas);
  }

  /** Places the camera for a tree of this size. */
  frame({ height_m, radius_m }: { height_m: number; radius_m: number }): void {
    const reach_m = Math.max(height_m, 2 * radius_m);
    this.ground.scale.setScalar(0.6 * reach_m);
    this.controls.target.set(0, 0.5 * height_m, 0);
    this.camera.position.set(1.1 * reach_m, 0.62 * height_m, 1.55 * reach_m);
    this.controls.minDistance = 0.3 * reach_m;
    this.controls.maxDistance = 4 * reach_m;
  }

  /** Directs a ray from the camera through a place on the canvas, in −1 … 1. */
  aim(ray: Raycaster, place: Vector2): void {
    ray.setFromCamera(place, this.camera);
  }

  /** Leaves the left button and a single finger to others; the right button and two fingers still turn the tree. */
  leavePointer(left: boolean): void {
    this.controls.mouseButtons = {
      LEFT: left ? null : MOUSE.ROTATE,
      MIDDLE: MOUSE.DOLLY,
      RIGHT: MOUSE.ROTATE,
    };
    this.controls.touches = { ONE: left ? null : TOUCH.ROTATE, TWO: TOUCH.DOLLY_ROTATE };
  }

  /** What the camera sees of an object of the scene: four bytes per pixel, the lowest line first. */
  read(object: Object3D, target: WebGLRenderTarget): Uint8Array {
    const pixels = new Uint8Array(4 * target.width * target.height);
    this.renderer.setRenderTarget(target);
    this.renderer.setClearColor(0, 0);
    this.renderer.render(object, this.camera);
    this.renderer.setRenderTarget(null);
    this.renderer.readRenderTargetPixels(target, 0, 0, target.width, target.height, pixels);
    return pixels;
  }

  render(): void {
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
  }

  private resize(canvas: HTMLCanvasElement): void {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  dispose(): void {
    this.resized.disconnect();
    this.ground.geometry.dispose();
    this.ground.material.dispose();
    this.controls.dispose();
    this.renderer.dispose();
  }
}
