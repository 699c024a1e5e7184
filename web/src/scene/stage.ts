/** Renderer, camera, sky, ground and light: everything except the trees. */
import {
  ACESFilmicToneMapping,
  Frustum,
  Matrix4,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { FarWood } from "./ground/farWood";
import { GroundCover } from "./ground/groundCover";
import { setGroundSeason } from "./ground/groundMaterial";
import { groundHeight_m } from "./ground/landscape";
import { Terrain } from "./ground/terrain";
import type { Quality } from "./quality";
import type { Season } from "./season/season";
import { Daylight } from "./sky/daylight";
import type { Atmosphere } from "./sky/daytime";
import { Sky } from "./sky/sky";
import { Pictures } from "./textures/pictures";
import type { View } from "./trees/drawList";

const PIXEL_RATIO: Record<Quality, number> = { low: 1, medium: 1.5, high: 2 };
const LEVEL_FROM_M: Record<Quality, [number, number]> = { low: [7, 24], medium: [34, 80], high: [52, 120] };
/** How much farther bare trees keep their full detail; the lowest quality draws no shoots in place of the leaves. */
const BARE_DETAIL: Record<Quality, number> = { low: 5, medium: 1.8, high: 1.2 };
const LOOK_AT_M = new Vector3(-1, 6.2, -16);
const EYE_M = { x: 7, above: 8.2, z: 24 };

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(46, 1, 0.3, 2600);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  private readonly pictures = new Pictures();
  readonly sky = new Sky(this.pictures);
  readonly daylight: Daylight;
  private readonly terrain = new Terrain(this.pictures);
  readonly cover: GroundCover;
  private readonly farWood = new FarWood();
  private readonly frustum = new Frustum();
  private readonly clip = new Matrix4();
  private readonly seen = new Matrix4();
  private readonly observer: ResizeObserver;
  private quality: Quality;
  private season: Season = "autumn";

  constructor(
    private readonly canvas: HTMLCanvasElement,
    quality: Quality,
  ) {
    this.quality = quality;
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: quality !== "low",
      powerPreference: "high-performance",
    });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.info.autoReset = false;
    this.pictures.setQuality(quality);
    this.daylight = new Daylight(quality);
    this.cover = new GroundCover(quality);
    this.scene.add(this.terrain.mesh, this.sky.mesh, this.cover.mesh, this.farWood.mesh, this.daylight.group);
    this.camera.position.set(EYE_M.x, groundHeight_m(EYE_M.x, EYE_M.z) + EYE_M.above, EYE_M.z);
    this.controls = this.orbit();
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas);
    this.resize();
  }

  private orbit(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.target.copy(LOOK_AT_M);
    controls.enableDamping = true;
    controls.dampingFactor = 0.12;
    controls.minDistance = 4;
    controls.maxDistance = 260;
    controls.maxPolarAngle = 0.53 * Math.PI;
    controls.listenToKeyEvents(this.canvas);
    controls.update();
    return controls;
  }

  private resize(): void {
    const width = Math.max(1, this.canvas.clientWidth);
    const height = Math.max(1, this.canvas.clientHeight);
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, PIXEL_RATIO[this.quality]));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // On a portrait screen, keep the horizontal field of view of a square one.
    this.camera.fov = this.camera.aspect < 1 ? 58 : 46;
    this.camera.updateProjectionMatrix();
  }

  /** Sets sky, light and ground for a season and time of day. */
  show(daytime: number, season: Season): Atmosphere {
    this.season = season;
    const light = this.daylight.show(daytime, season);
    this.sky.show(light);
    setGroundSeason(season);
    this.cover.setSeason(season);
    this.farWood.show(light, season);
    this.renderer.toneMappingExposure = light.exposure;
    return light;
  }

  /** Places the background forest around simulated trees of this extent. */
  surround(reach_m: number): void {
    this.farWood.populate(reach_m, this.quality);
  }

  setQuality(quality: Quality): void {
    this.quality = quality;
    this.pictures.setQuality(quality);
    this.cover.setQuality(quality);
    this.daylight.setQuality(quality);
    this.resize();
  }

  /** Updates the camera; returns whether it moved, so that trees must be selected again. */
  updateCamera(): boolean {
    this.controls.update();
    const floor_m = groundHeight_m(this.camera.position.x, this.camera.position.z) + 1.4;
    if (this.camera.position.y < floor_m) this.camera.position.y = floor_m;
    this.camera.updateMatrixWorld();
    this.clip.multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    if (this.clip.equals(this.seen)) return false;
    this.seen.copy(this.clip);
    return true;
  }

  /** Bare trees keep their full detail up to a larger distance, because thin twigs are all that they show. */
  private levelFrom_m(): readonly [number, number] {
    const [first, second] = LEVEL_FROM_M[this.quality];
    const further = this.season === "winter" ? BARE_DETAIL[this.quality] : 1;
    return [further * first, further * second];
  }

  view(): View {
    return {
      planes: this.frustum.setFromProjectionMatrix(this.clip).planes,
      eye: this.camera.position,
      sun: this.daylight.towardsSun,
      levelFrom_m: this.levelFrom_m(),
      shadow_m: this.daylight.shadowReach_m,
    };
  }

  render(): void {
    this.renderer.render(this.scene, this.camera);
  }

  dispose(): void {
    this.observer.disconnect();
    this.controls.dispose();
    this.sky.dispose();
    this.terrain.dispose();
    this.cover.dispose();
    this.farWood.dispose();
    this.pictures.dispose();
    this.daylight.dispose();
    this.renderer.dispose();
  }
}
