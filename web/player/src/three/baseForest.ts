/** A forest as an object of three.js, whichever of its renderers draws it. */
import {
  type Camera,
  Group,
  type Intersection,
  Matrix4,
  type Object3D,
  type Raycaster,
  Ray as ThreeRay,
  Vector3,
} from "three";
import { checkedWind, type Point, velocityAt, type Wind } from "../core/forest/givenWind";
import { checkStep } from "../core/motion/steppedTrees";
import { faultOf, fileBytes } from "../core/net/fileBytes";
import type { DrawnMotion } from "../core/table/drawnTable";
import { openMesh } from "../trees/mesh/openMesh";
import { disposeModel, readPlainTree, type TreeModel } from "../trees/mesh/treeMesh";
import type { NodeRenderer, TreeGraphics } from "../trees/nodes/nodeGraphics";
import type { MaterialMaker } from "../trees/partMaterials";
import { SpeciesForest, type SpeciesOptions } from "../trees/speciesForest";
import { pickTree } from "../trees/treePick";
import type { WorkerPort } from "../worker/divided/dividedWorker";
import { type MaterialFactory, ownMaterial } from "./ownMaterial";
import { Planted } from "./planted";
import { instancesOf, placementOf } from "./standing";
import { Viewer, type ViewOptions } from "./view";
import { startWorker, WorkerClient } from "./worker";

/** The files of a tree: addresses, or their contents. */
export interface TreeFiles {
  /** Its lookup table. */
  readonly table: string | URL | ArrayBuffer;
  /** The GLB whose vertices the table moves. */
  readonly mesh: string | URL | ArrayBuffer;
}

export interface ForestOptions extends Partial<ViewOptions> {
  readonly wind: Wind;
  /** Materials instead of those in the meshes. */
  readonly materials?: MaterialFactory;
  /**
   * Starts `galewood.worker.js`, where a bundler does not find it, or another worker: `severalWorkers` of `galewood/workers`,
   * `streamed` of `galewood/stream`. `start`: starts the usual one.
   */
  readonly worker?: (start: () => Worker) => WorkerPort;
}

/** A tree that a ray has hit. */
export interface Pick {
  readonly trees: Planted;
  /** Index of the tree among those. */
  readonly tree: number;
  readonly distance_m: number;
  /** Where, in the world. */
  readonly point: Vector3;
}

/** A renderer of scenes: WebGLRenderer, WebGPURenderer. */
type SceneRenderer = NodeRenderer & { readonly xr: { enabled: boolean } };

/** Materials by a factory, with the deformation of the trees. `leafShare`: share of the leaves on the trees. */
export type Materials = (factory: MaterialFactory, leafShare: { value: number }) => MaterialMaker;

interface Loaded {
  readonly table: number;
  readonly motion: DrawnMotion;
  readonly model: TreeModel;
}

/** Texels that every device with WebGL 2 that three.js supports has room for. */
const MAX_TEXTURE_SIDE = 4096;

const absolute = (from: string | URL | ArrayBuffer) =>
  from instanceof ArrayBuffer ? from : new URL(from, document.baseURI).href;

/** To what the addresses of a mesh's pictures are relative: its folder, or for contents the page. */
const baseOf = (mesh: string | URL | ArrayBuffer) => `${absolute(mesh)}`.replace(/[^/?]*(\?.*)?$/, "");

async function modelOf(mesh: string | URL | ArrayBuffer): Promise<TreeModel> {
  const from = absolute(mesh);
  try {
    const bytes = from instanceof ArrayBuffer ? from : await fileBytes(from, fetch(from));
    return readPlainTree(await openMesh(bytes, baseOf(mesh)));
  } catch (error) {
    throw new Error(faultOf(from, error), { cause: error });
  }
}

/** Checks that a table was made for a mesh. */
function checkFit({ motion, model }: Loaded, mesh: TreeFiles["mesh"]): void {
  const vertices = model.parts.reduce((sum, part) => sum + part.vertices, 0);
  if (vertices !== motion.vertexJoint.length)
    throw new Error(
      faultOf(
        absolute(mesh),
        `the table moves ${motion.vertexJoint.length} vertices, this mesh has ${vertices}: use the GLB that belongs to it`,
      ),
    );
}

/** Forests of all renderers. */
export class BaseForest extends Group {
  /** Level of detail and shadows; may be changed at any time. */
  readonly viewing: ViewOptions;
  private readonly client: WorkerClient;
  /**
   * Trees by the addresses of their files. A cache of its own, unlike the worker's `TableStore`, which knows neither meshes
   * nor this forest's graphics memory: what is loaded here is disposed of with the forest.
   */
  private readonly loaded = new Map<string, Promise<Loaded>>();
  private readonly groves = new Map<number, Planted>();
  private readonly models = new Set<TreeModel>();
  private readonly viewer = new Viewer();
  private readonly species: SpeciesOptions;
  private readonly leafShare = { value: 1 };
  private readonly from = new Matrix4();
  private readonly ray = new ThreeRay();
  private readonly inverse = new Matrix4();
  private blowing: Wind;
  private changed = true;
  /** The renderer that has drawn the nodes since the last update. */
  private drawnBy: NodeRenderer | null = null;
  private hooked: Object3D | null = null;
  private unset = () => {};
  private disposed = false;

  /** `graphics`, `makerOf`: those of the renderer. */
  constructor(
    graphics: TreeGraphics,
    makerOf: Materials,
    { wind, materials = ownMaterial, worker = startWorker, ...view }: ForestOptions,
  ) {
    super();
    this.blowing = checkedWind(wind); // before a worker is started
    this.viewing = { detail_m: view.detail_m ?? [34, 80], shadow_m: view.shadow_m ?? 120 };
    this.client = new WorkerClient(worker(startWorker));
    this.client.failed = (fault) => {
      if (!this.disposed) console.error(fault);
    };
    this.species = {
      graphics,
      materials: makerOf(materials, this.leafShare),
      maxTextureSide: MAX_TEXTURE_SIDE,
      shadows: { share: 1 },
      fine: false,
      flutter: { value: { x: 0, y: 1 } },
      exaggeration: { value: 1 },
    };
    this.wind = this.blowing;
  }

  /**
   * The wind: a document (spec/formats/wind.md), or a function. A new document takes over within 0.6 s; one with a mistake
   * throws WindError, and the wind stays as it was.
   */
  get wind(): Wind {
    return this.blowing;
  }

  set wind(given: Wind) {
    const wind = checkedWind(given);
    this.blowing = wind;
    this.client.setWind(typeof wind === "function" ? null : wind);
  }

  /** Time of the motion, s. */
  get time_s(): number {
    return this.client.time_s;
  }

  /** Factor of all displacements on screen; 1 by default. */
  get exaggeration(): number {
    return this.species.exaggeration.value;
  }

  set exaggeration(factor: number) {
    this.species.exaggeration.value = factor;
    this.changed = true;
  }

  /** Amplitude of the flutter of leaves; 0 disables it. */
  get flutter(): number {
    return this.species.flutter.value.y;
  }

  set flutter(amplitude: number) {
    this.species.flutter.value.y = amplitude;
  }

  /** Share of the leaves that are on the trees. */
  get leaves(): number {
    return this.leafShare.value;
  }

  set leaves(share: number) {
    this.leafShare.value = share;
  }

  /** All that is planted. */
  get planted(): readonly Planted[] {
    return [...this.groves.values()];
  }

  private load({ table, mesh }: TreeFiles): Promise<Loaded> {
    const read = async (): Promise<Loaded> => {
      const [read_, model] = await Promise.all([this.client.load(absolute(table)), modelOf(mesh)]);
      const loaded = { ...read_, model };
      checkFit(loaded, mesh);
      this.models.add(model);
      return loaded;
    };
    if (table instanceof ArrayBuffer || mesh instanceof ArrayBuffer) return read();
    const key = `${absolute(table)} ${absolute(mesh)}`;
    const known = this.loaded.get(key) ?? read();
    this.loaded.set(key, known);
    known.catch(() => this.loaded.delete(key));
    return known;
  }

  /**
   * Plants a tree at each matrix, which places the tree's frame (metres, y up, origin at the foot) in that of the forest.
   * Rejects if a file cannot be read or the two do not belong together, with an AbortError if the forest is disposed of
   * meanwhile.
   */
  async plant(files: TreeFiles, places: readonly Matrix4[]): Promise<Planted> {
    const { table, motion, model } = await this.load(files);
    if (this.disposed) throw new DOMException("the forest was disposed of", "AbortError");
    const matrices = places.map((matrix) => matrix.clone());
    this.updateWorldMatrix(true, false);
    const trees = new SpeciesForest(model, motion, instancesOf(matrices), this.species);
    const group = this.client.plant(table, placementOf(matrices, this.matrixWorld), motion.stride);
    const planted = new Planted(
      group,
      table,
      motion,
      trees,
      matrices,
      () => this.client.poses(group),
      () => this.matrixWorld,
    );
    this.groves.set(group, planted);
    this.add(trees.group);
    this.changed = true;
    return planted;
  }

  /** Moves planted trees; they keep their pose. */
  move(planted: Planted, places: readonly Matrix4[]): void {
    if (places.length !== planted.count)
      throw new RangeError(
        `expected ${planted.count} matrices, not ${places.length}: plant the other trees separately`,
      );
    planted.matrices = places.map((matrix) => matrix.clone());
    planted.trees.setInstances(instancesOf(planted.matrices));
    this.client.move(planted.group, planted.table, placementOf(planted.matrices, this.matrixWorld));
    this.changed = true;
  }

  /** Removes planted trees. */
  uproot(planted: Planted): void {
    this.groves.delete(planted.group);
    this.client.remove(planted.group);
    planted.trees.dispose();
  }

  /** Advances the motion by dt_s (s) and selects what this camera sees. Call it before every picture. */
  update(dt_s: number, camera: Camera): void {
    checkStep(dt_s);
    this.drawnBy = null;
    this.updateWorldMatrix(true, false);
    this.follow();
    this.hook();
    const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
    this.client.advance(dt_s, [eye.x, eye.z], this.blow);
    const fresh = this.client.takeFresh();
    this.species.flutter.value.x = this.client.time_s;
    const look = this.viewer.look(camera, this, this.viewing) || this.changed;
    this.changed = false;
    const view = look ? this.viewer.view(camera, this.viewing) : null;
    for (const { group, trees } of this.groves.values()) {
      if (view) trees.select(view);
      const poses = fresh && this.client.poses(group);
      if (poses) trees.setPoses(poses);
    }
  }

  /** The trees feel the wind where they are in the world. */
  private follow(): void {
    if (this.from.equals(this.matrixWorld)) return;
    this.from.copy(this.matrixWorld);
    for (const { group, table, matrices } of this.groves.values())
      this.client.move(group, table, placementOf(matrices, this.matrixWorld));
  }

  private get blow() {
    const wind = this.blowing;
    if (typeof wind !== "function") return null;
    const at: Point = new Vector3();
    return (group: number, velocity: Float32Array, time_s: number) => {
      for (const [k, matrix] of this.groves.get(group)?.matrices.entries() ?? []) {
        (at as Vector3).setFromMatrixPosition(matrix).applyMatrix4(this.matrixWorld);
        const { x, z } = velocityAt(wind, at, time_s);
        velocity[2 * k] = x;
        velocity[2 * k + 1] = z;
      }
    };
  }

  /** Moves the nodes before every picture of the scene. */
  private hook(): void {
    let root: Object3D = this;
    while (root.parent) root = root.parent;
    if (root === this || root === this.hooked) return;
    this.unset();
    this.hooked = root;
    const { onBeforeRender } = root;
    const hooked: Object3D["onBeforeRender"] = (renderer, ...more) => {
      onBeforeRender.call(root, renderer, ...more);
      this.renderNodes(renderer);
    };
    root.onBeforeRender = hooked;
    this.unset = () => {
      if (root.onBeforeRender === hooked) root.onBeforeRender = onBeforeRender;
    };
  }

  /** Once per update: WebGPURenderer draws shadow maps as pictures of the scene, too. */
  private renderNodes(renderer: SceneRenderer): void {
    if (this.drawnBy === renderer) return;
    this.drawnBy = renderer;
    const { xr } = renderer;
    const immersive = xr.enabled;
    xr.enabled = false;
    for (const { trees } of this.groves.values()) trees.renderNodes(renderer);
    xr.enabled = immersive;
  }

  /** The first tree that a ray hits, where it is at the moment; null if it hits none. */
  pick({ ray, near, far }: Raycaster): Pick | null {
    this.ray.copy(ray).applyMatrix4(this.inverse.copy(this.matrixWorld).invert());
    const groves = this.planted;
    const groups = groves.map(({ trees, group }) => ({ ...trees.pickable, poses: this.client.poses(group) }));
    const hit = pickTree(groups, { from: this.ray.origin, to: this.ray.direction });
    if (!hit) return null;
    const point = this.ray.at(hit.distance_m, new Vector3()).applyMatrix4(this.matrixWorld);
    const distance_m = point.distanceTo(ray.origin);
    if (distance_m < near || distance_m > far) return null;
    return { trees: groves[hit.group], tree: hit.tree, distance_m, point };
  }

  /** The same for `Raycaster.intersectObject`, and thereby for pointer events of react-three-fiber. */
  override raycast(raycaster: Raycaster, intersects: Intersection[]): void {
    const hit = this.pick(raycaster);
    if (hit)
      intersects.push({ distance: hit.distance_m, point: hit.point, object: this, instanceId: hit.tree });
  }

  /** Ends the worker and frees the memory of the graphics device. */
  override dispose(): void {
    this.disposed = true;
    this.unset();
    this.client.dispose();
    for (const { trees } of this.groves.values()) trees.dispose();
    for (const model of this.models) disposeModel(model);
    this.groves.clear();
    this.removeFromParent();
  }
}
