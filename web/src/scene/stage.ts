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
import { FarWood, type Planted } from "./ground/farWood";
import { GroundCover } from "./ground/groundCover";
import { setGroundSeason } from "./ground/groundMaterial";
import { groundHeight_m } from "./ground/landscape";
import { Terrain } from "./ground/terrain";
import { shared as impostorUniforms } from "./impostors/cardMaterial";
import { castShade, groundShade } from "./impostors/groundShade";
import { ImpostorLibrary } from "./impostors/library";
import type { Quality } from "./quality";
import type { Season } from "./season/season";
import { Daylight } from "./sky/daylight";
import type { Atmosphere } from "./sky/daytime";
import { Sky } from "./sky/sky";
import { Pictures } from "./textures/pictures";
import type { View } from "./trees/drawList";

const PIXEL_RATIO: Record<Quality, number> = { low: 1, medium: 1.5, high: 2 };
const LEVEL_FROM_M: Record<Quality, [number, number]> = { low: [7, 24], medium: [34, 80], high: [52, 120] };
const BARE_DETAIL = 5;
/** Distance from which simulated trees of scale 1 are drawn as impostors. */
const CARDS_FROM_M: Record<Quality, number> = { low: 60, medium: 85, high: 120 };
const SHADE_EVERY_MS = 300;
/** Side of the picture from which each view of an impostor is reduced, px. */
const BAKED_PX: Record<Quality, number> = { low: 256, medium: 512, high: 512 };
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
  readonly impostors: ImpostorLibrary;
  readonly farWood: FarWood;
  /** Whether trees must be selected again although the camera stands still. */
  private impostorsChanged = false;
  /** The simulated trees whose shadows lie on distant ground. */
  private shading: Float32Array = new Float32Array(0);
  private shadeOutdated = false;
  private shaded_ms = 0;
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
    this.impostors = new ImpostorLibrary(BAKED_PX[quality]);
    this.impostors.from_m = CARDS_FROM_M[quality];
    this.farWood = new FarWood(this.impostors);
    canvas.addEventListener("webglcontextrestored", this.renewImpostors);
    this.cover = new GroundCover(quality);
    this.scene.add(
      this.terrain.mesh,
      this.sky.mesh,
      this.cover.mesh,
      this.farWood.group,
      this.daylight.group,
    );
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
    this.shadeOutdated = true;
    this.farWood.setSeason(season);
    this.impostors.setLeafless(season === "winter");
    impostorUniforms.uBare.value = season === "winter" ? 1 : 0;
    this.impostorsChanged = true;
    this.renderer.toneMappingExposure = light.exposure;
    return light;
  }

  /** Plants the background forest around the simulated trees. */
  surround(planted: Planted): void {
    const models = planted.assets.filter(({ model }) => model !== null);
    models.sort((a, b) => Number(b.builtin) - Number(a.builtin));
    this.impostors.keep(models.flatMap(({ model }) => model ?? []));
    this.farWood.populate(planted, this.quality);
    this.shading = planted.trees;
    this.shadeOutdated = true;
    this.impostorsChanged = true;
  }

  private readonly renewImpostors = (): void => {
    this.impostors.renew();
    this.impostorsChanged = true;
  };

  setQuality(quality: Quality): void {
    this.quality = quality;
    this.pictures.setQuality(quality);
    this.cover.setQuality(quality);
    this.daylight.setQuality(quality);
    this.impostors.setDetail(BAKED_PX[quality]);
    this.impostors.from_m = CARDS_FROM_M[quality];
    this.resize();
  }

  /** Updates the camera; returns whether trees must be selected again, because it moved or impostors changed. */
  updateCamera(): boolean {
    this.controls.update();
    const floor_m = groundHeight_m(this.camera.position.x, this.camera.position.z) + 1.4;
    if (this.camera.position.y < floor_m) this.camera.position.y = floor_m;
    this.camera.updateMatrixWorld();
    this.clip.multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    const changed = this.impostorsChanged || this.impostors.arriving;
    this.impostorsChanged = false;
    this.impostors.arriving = false;
    if (this.clip.equals(this.seen) && !changed) return false;
    this.seen.copy(this.clip);
    return true;
  }

  /** Bare trees keep their full detail up to a larger distance, because their leaves are not drawn. */
  private levelFrom_m(): readonly [number, number] {
    const [first, second] = LEVEL_FROM_M[this.quality];
    return this.season === "winter" ? [BARE_DETAIL * first, BARE_DETAIL * second] : [first, second];
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

  /** Selects the background trees of the current view. */
  select(view: View): void {
    this.farWood.select(view);
  }

  /** Whether all impostors are baked, and the number of background trees. */
  get impostorFigures(): { ready: boolean; backgroundTrees: number } {
    return { ready: this.impostors.isReady, backgroundTrees: this.farWood.count };
  }

  /** Renews the shadows on distant ground, which takes some milliseconds, not in every frame of a moving sun. */
  private shadeGround(): void {
    const now_ms = performance.now();
    const reach_m = this.daylight.shadowReach_m;
    groundShade.uShadeFrom.value.set(0.75 * reach_m, reach_m);
    if (!this.shadeOutdated || now_ms - this.shaded_ms < SHADE_EVERY_MS) return;
    this.shadeOutdated = false;
    this.shaded_ms = now_ms;
    castShade(Float32Array.from([...this.shading, ...this.farWood.shading]), this.daylight.towardsSun);
  }

  render(): void {
    this.shadeGround();
    if (this.impostors.work(this.renderer)) this.impostorsChanged = true;
    this.renderer.render(this.scene, this.camera);
  }

  dispose(): void {
    this.observer.disconnect();
    this.controls.dispose();
    this.sky.dispose();
    this.terrain.dispose();
    this.cover.dispose();
    this.farWood.dispose();
    this.impostors.dispose();
    this.canvas.removeEventListener("webglcontextrestored", this.renewImpostors);
    this.pictures.dispose();
    this.daylight.dispose();
    this.renderer.dispose();
  }
}
