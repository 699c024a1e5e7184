/** Renderer, camera, sky, ground and light: everything except the trees. */

import type { View } from "galewood/trees";
import type { WindField } from "galewood/wind";
import {
  ACESFilmicToneMapping,
  Frustum,
  Matrix4,
  type Object3D,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  type Vector3Like,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { AmbientOcclusion } from "./ambientOcclusion";
import { Backdrop } from "./background/backdrop";
import type { Planted } from "./background/farWood";
import { EDGE_VIEW } from "./camera/viewpoints";
import { DetailBudget } from "./detailBudget";
import { GroundCover } from "./ground/groundCover";
import { setGroundSeason } from "./ground/groundMaterial";
import { GroundWind } from "./ground/groundWind";
import { groundHeight_m } from "./ground/landscape";
import { StemFeet } from "./ground/stemFeet";
import { Terrain } from "./ground/terrain";
import { Undergrowth } from "./ground/undergrowth";
import { isAntialiased, type Quality } from "./quality";
import { FlyingLeaves } from "./season/flyingLeaves";
import type { Season } from "./season/season";
import { Snowfall } from "./season/snowfall";
import { Daylight } from "./sky/daylight";
import type { Atmosphere } from "./sky/daytime";
import type { Crowns } from "./sky/exposure";
import { Lighting } from "./sky/lighting";
import { Sky } from "./sky/sky";
import { Pictures } from "./textures/pictures";

const PIXEL_RATIO: Record<Quality, number> = { low: 1, medium: 1.5, high: 2 };
/** Pixels drawn per pixel of the screen, along each side: low quality draws about half of them on screens of ordinary density. */
const SHARPNESS: Record<Quality, number> = { low: 0.75, medium: 1, high: 1 };
/** The same, relative to that, in the first pictures, which processors take long to draw. */
const FIRST_SHARPNESS: Record<Quality, number> = { low: 0.5, medium: 1, high: 1 };
/** While the camera stands still, shadows are drawn again after this many pictures. */
const SHADOW_PERIOD: Record<Quality, number> = { low: 3, medium: 1, high: 1 };
const LEVEL_FROM_M: Record<Quality, [number, number]> = { low: [7, 24], medium: [22, 58], high: [48, 112] };
/** Triangles of the trees in a picture at most. */
const MOST_TRIANGLES: Record<Quality, number> = { low: 0.8e6, medium: 2.5e6, high: 6e6 };
/** Distance (m) below which leaf cards give way to sprays; the lowest quality has none. */
const SPRAYS_M: Record<Quality, number> = { low: 0, medium: 15, high: 24 };
/** Distance (m) up to which leaves are drawn one by one. */
const SINGLES_M: Record<Quality, number> = { low: 0, medium: 4, high: 4 };
/** How much farther bare trees keep their full detail; the lowest quality draws no shoots in place of the leaves. */
const BARE_DETAIL: Record<Quality, number> = { low: 4, medium: 1, high: 0.95 };
/** How near the visitor may come to what the camera looks at. */
const NEAREST_M = 1;
/** How far the view may be turned up, as the angle of the camera from above its target: crowns are seen from below. */
const MAX_POLAR_RAD = 0.75 * Math.PI;

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(46, 1, 0.3, 2600);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  private readonly pictures = new Pictures();
  readonly sky = new Sky(this.pictures);
  readonly daylight: Daylight;
  private readonly terrain = new Terrain(this.pictures);
  private readonly feet = new StemFeet();
  private readonly lighting: Lighting;
  private readonly wind = new GroundWind();
  private readonly undergrowth: Undergrowth;
  private readonly leaves: FlyingLeaves;
  private readonly snow: Snowfall;
  readonly cover: GroundCover;
  readonly backdrop: Backdrop;
  /** What the first pictures of the trees do without, and then show one after the other. */
  private readonly later: Object3D[];
  /** Whether all of it is there, and casts shadows. */
  private isWhole = false;
  private readonly frustum = new Frustum();
  private readonly clip = new Matrix4();
  private readonly seen = new Matrix4();
  private readonly observer: ResizeObserver;
  private quality: Quality;
  private readonly budget = new DetailBudget();
  /** Whether the next pictures have all pixels of the screen at any quality, for a photo. */
  sharp = false;
  private drawnSharpness = 1;
  private occlusion: AmbientOcclusion | null = null;
  /** Number of pictures that show the present shadows; infinite if these are outdated. */
  private shadowAge = Number.POSITIVE_INFINITY;
  private sheltering: Crowns = new Float32Array(0);
  private season: Season = "autumn";

  constructor(
    private readonly canvas: HTMLCanvasElement,
    quality: Quality,
  ) {
    this.quality = quality;
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: isAntialiased(quality),
      powerPreference: "high-performance",
    });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false; // see render()
    this.renderer.info.autoReset = false;
    this.pictures.setQuality(quality);
    this.daylight = new Daylight(quality);
    this.lighting = new Lighting(this.sky, this.daylight);
    this.backdrop = new Backdrop(canvas, this.daylight, quality, this.pictures.noise);
    this.cover = new GroundCover(quality, this.wind);
    this.undergrowth = new Undergrowth(quality, this.pictures, this.wind);
    this.leaves = new FlyingLeaves(quality, groundHeight_m);
    this.snow = new Snowfall(quality);
    this.later = [
      this.cover.mesh,
      this.undergrowth.group,
      this.feet.mesh,
      this.leaves.mesh,
      this.snow.mesh,
      this.backdrop.wood.group,
      this.backdrop.canopy.mesh,
    ];
    this.scene.add(this.terrain.mesh, this.sky.mesh, this.daylight.group);
    this.camera.position.copy(EDGE_VIEW.eye);
    this.controls = this.orbit();
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas);
    this.resize();
  }

  /**
   * Has the driver compile the shaders of the first picture, in which `standIns` stand for trees. Drivers finish that only when a shader is
   * first drawn with, so one pixel is drawn.
   */
  warmUp(standIns: Object3D): void {
    const { renderer, scene, camera } = this;
    renderer.compile(scene, camera);
    renderer.compile(standIns, camera, scene);
    scene.add(standIns);
    renderer.setScissor(0, 0, 1, 1);
    renderer.setScissorTest(true);
    renderer.render(scene, camera);
    renderer.setScissorTest(false);
    scene.remove(standIns);
  }

  /** Computes the shape of the land and the noise of sky and ground, which takes a while. Call before the first picture. */
  shapeLand(): void {
    this.terrain.shape();
    this.pictures.paintNoise();
  }

  private orbit(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.target.copy(EDGE_VIEW.target);
    controls.enableDamping = true;
    controls.dampingFactor = 0.12;
    controls.minDistance = NEAREST_M;
    controls.maxDistance = 260;
    controls.maxPolarAngle = MAX_POLAR_RAD;
    controls.listenToKeyEvents(this.canvas);
    controls.update();
    return controls;
  }

  private resize(): void {
    const width = Math.max(1, this.canvas.clientWidth);
    const height = Math.max(1, this.canvas.clientHeight);
    const { quality } = this;
    this.drawnSharpness = this.sharpness;
    this.renderer.setPixelRatio(Math.min(this.drawnSharpness * devicePixelRatio, PIXEL_RATIO[quality]));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // On a portrait screen, keep the horizontal field of view of a square one.
    this.camera.fov = this.camera.aspect < 1 ? 58 : 46;
    this.camera.updateProjectionMatrix();
  }

  private get sharpness(): number {
    if (this.sharp) return 1;
    const isFirst = !this.cover.mesh.parent; // nothing grows yet
    return SHARPNESS[this.quality] * (isFirst ? FIRST_SHARPNESS[this.quality] : 1);
  }

  /** Draws with ambient occlusion, or without. */
  occlude(occlusion: typeof AmbientOcclusion | null): void {
    this.occlusion?.dispose();
    this.occlusion = occlusion && new occlusion(this.renderer, this.scene, this.camera);
  }

  /** Sets sky, light and ground for a season and time of day. */
  show(daytime: number, season: Season): Atmosphere {
    setGroundSeason(season);
    this.cover.setSeason(season);
    this.undergrowth.setSeason(season);
    this.season = season;
    const light = this.lighting.choose(daytime, season);
    this.shadowAge = Number.POSITIVE_INFINITY;
    this.backdrop.setSeason(season);
    return light;
  }

  /** Tells the scene where the trees stand, for the exposure and the undergrowth in their shade. */
  shelter(crowns: Crowns): void {
    const { sheltering: before } = this;
    if (crowns.length === before.length && crowns.every((value, k) => value === before[k])) return;
    this.sheltering = crowns;
    this.lighting.crowns = crowns;
    this.undergrowth.shelter(crowns);
    this.feet.shelter(crowns);
    this.backdrop.shelter(crowns);
  }

  /**
   * Moves sky, flying leaves, snow and ground cover on by dt_s in a mean wind; the clouds follow its strength.
   * `gusts`: the wind at each place, in which the ground cover bows. `more`: how many of the things that grow and fly around the trees
   * are there from now on; shadows come after the last of them. The driver takes long to make each ready.
   */
  advance(
    dt_s: number,
    wind_m_s: { x: number; z: number },
    gusts: WindField,
    time_s: number,
    more: number,
  ): void {
    this.lighting.advance(dt_s, wind_m_s);
    this.isWhole = more > this.later.length;
    for (const object of this.later.splice(0, more)) this.scene.add(object);
    if (!this.cover.mesh.parent) return; // nothing grows yet
    this.leaves.advance(
      dt_s,
      wind_m_s,
      this.season,
      this.lighting.crownsNear(this.camera.position),
      this.camera.position,
    );
    this.snow.advance(dt_s, wind_m_s, this.season);
    this.wind.update(gusts, time_s, this.camera.position);
    this.cover.update(this.camera.position, time_s);
    this.undergrowth.update(this.camera.position, time_s);
    this.feet.update(this.camera.position);
  }

  /** Moves the camera to another place, whose light the exposure takes at once. */
  cutTo(eye: Vector3Like, target: Vector3Like): void {
    this.camera.position.copy(eye);
    this.controls.target.copy(target);
    this.lighting.adaptAtOnce();
  }

  /** Plants the background forest around the simulated trees. */
  surround(planted: Planted): void {
    this.shadowAge = Number.POSITIVE_INFINITY;
    this.backdrop.surround(planted);
  }

  setQuality(quality: Quality): void {
    this.quality = quality;
    this.shadowAge = Number.POSITIVE_INFINITY;
    this.pictures.setQuality(quality);
    this.cover.setQuality(quality);
    this.undergrowth.setQuality(quality);
    this.leaves.setQuality(quality);
    this.snow.setQuality(quality);
    this.daylight.setQuality(quality);
    this.backdrop.setQuality(quality);
    this.resize();
  }

  /** Updates the camera; returns whether trees must be selected again, because it moved or impostors changed. */
  updateCamera(): boolean {
    this.controls.update();
    const floor_m = groundHeight_m(this.camera.position.x, this.camera.position.z) + 1.4;
    if (this.camera.position.y < floor_m) this.camera.position.y = floor_m;
    this.camera.updateMatrixWorld();
    this.clip.multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    const changed = this.backdrop.takeChange();
    if (this.clip.equals(this.seen) && !changed) return false;
    this.seen.copy(this.clip);
    this.shadowAge = Number.POSITIVE_INFINITY;
    return true;
  }

  /** Bare trees keep their full detail up to a larger distance, because thin twigs are all that they show. */
  private levelFrom_m(): readonly [number, number] {
    const [first, second] = LEVEL_FROM_M[this.quality];
    const further = this.budget.reach * (this.season === "winter" ? BARE_DETAIL[this.quality] : 1);
    return [further * first, further * second];
  }

  /** Takes the triangles of the trees selected for the present view. Returns whether they must be selected again, with more or less detail. */
  weigh(triangles: number): boolean {
    return this.budget.take(triangles, MOST_TRIANGLES[this.quality]);
  }

  view(): View {
    return {
      planes: this.frustum.setFromProjectionMatrix(this.clip).planes,
      eye: this.camera.position,
      sun: this.daylight.towardsSun,
      levelFrom_m: this.levelFrom_m(),
      near_m: this.budget.reach * SPRAYS_M[this.quality],
      close_m: SINGLES_M[this.quality],
      shadow_m: this.daylight.shadowReach_m,
    };
  }

  /** Whether shadows are drawn in this picture. */
  private castsAnew(): boolean {
    this.shadowAge = this.shadowAge >= SHADOW_PERIOD[this.quality] ? 1 : this.shadowAge + 1;
    return this.shadowAge === 1;
  }

  /** `dt_s`: time since the last picture, in which the exposure adapts. */
  render(dt_s: number): void {
    if (this.sharpness !== this.drawnSharpness) this.resize(); // here, because it clears the canvas
    this.renderer.shadowMap.autoUpdate = this.isWhole && this.castsAnew();
    if (this.renderer.shadowMap.autoUpdate) this.daylight.makeShadowMap();
    if (this.isWhole) this.backdrop.prepare(this.renderer);
    this.renderer.toneMappingExposure = this.lighting.expose(dt_s, this.camera);
    if (this.occlusion) this.occlusion.render();
    else this.renderer.render(this.scene, this.camera);
    this.pictures.paint();
  }

  /** Tells later whether the graphics have finished all that has been drawn until now. */
  fence(): () => boolean {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    // After a lost context has been restored, its old fence is invalid and would never be signalled.
    return () => !sync || !gl.isSync(sync) || gl.getSyncParameter(sync, gl.SYNC_STATUS) === gl.SIGNALED;
  }

  dispose(): void {
    this.observer.disconnect();
    this.controls.dispose();
    this.sky.dispose();
    this.terrain.dispose();
    this.feet.dispose();
    this.cover.dispose();
    this.wind.dispose();
    this.undergrowth.dispose();
    this.leaves.dispose();
    this.snow.dispose();
    this.backdrop.dispose();
    this.pictures.dispose();
    this.daylight.dispose();
    this.occlusion?.dispose();
    this.renderer.dispose();
  }
}
