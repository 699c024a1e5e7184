/** The forest on screen: one SpeciesForest per species, on shared placements. */

import type { TableMotion } from "galewood/client";
import type { Ray, View } from "galewood/trees";
import {
  createInstanceData,
  disposeModel,
  INSTANCE_FLOATS,
  type InstanceData,
  type Placement,
  pickTree,
  SpeciesForest,
  type SpeciesOptions,
  setTints,
  type TreeModel,
} from "galewood/trees";
import { Group, type WebGLRenderer } from "three";
import type { Viewpoint } from "./camera/viewpoints";
import { type Form, type FormChoice, plant } from "./forms";
import { groundHeight_m } from "./ground/landscape";
import type { ImpostorLibrary } from "./impostors/library";
import { placeTrees } from "./placement";
import { leafTint } from "./season/palette";
import type { Season } from "./season/season";
import { CROWN_FLOATS, type Crowns } from "./sky/exposure";

/** A tree of one species and form; not drawn until its model is loaded. */
export interface TreeAsset {
  readonly id: string;
  readonly species: string | null;
  readonly builtin: boolean;
  readonly form: Form;
  /** Whether the server has its mesh and table. */
  hasTable: boolean;
  model: TreeModel | null;
  /** null until the table is loaded; until then the trees stand still. */
  motion: TableMotion | null;
}

/** The trees of one species in a placement. */
export interface PlacedSpecies {
  readonly asset: TreeAsset;
  readonly model: TreeModel;
  readonly motion: TableMotion | null;
  readonly instances: InstanceData;
}

/** A moving group; the order is that of worker and server. */
export interface MovingGroup {
  readonly asset: TreeAsset;
  readonly forest: SpeciesForest<TableMotion>;
}

/** A tree that was picked. */
export interface PickedTree {
  /** Id of its place; unaffected by other trees. */
  readonly id: number;
  /** Id of the species or upload on the server. */
  readonly treeId: string;
  readonly species: string | null;
  readonly position: { x: number; y: number; z: number };
  readonly height_m: number;
  readonly radius_m: number;
  /** Distance from the eye to the hit point. */
  readonly distance_m: number;
}

/** A tree at its place. */
export interface PlantedTree {
  readonly asset: TreeAsset;
  readonly place: Placement;
}

export interface PlacementOptions {
  /** Relative to the default. */
  readonly density?: number;
  /** Relative frequency of each species by id; 1 if omitted. */
  readonly shares?: Readonly<Record<string, number>>;
  readonly form?: FormChoice;
  readonly season?: Season;
  /** Whether a tree is planted at the places of the forest; all are if omitted. */
  readonly grows?: (asset: TreeAsset) => boolean;
  /** Further places of single trees, by id. */
  readonly single?: Readonly<Record<string, Placement>>;
  /** What is planted in place of the tree that was chosen for a place; that one if omitted. */
  readonly instead?: (asset: TreeAsset, place: Placement) => PlantedTree;
}

/**
 * Assigns species to places: the open-grown form at the edge, the forest-grown one inside. Places depend only on seed
 * and number, so that existing trees stay in place.
 */
export function placeForest(
  assets: readonly TreeAsset[],
  count: number,
  seed: number,
  options: PlacementOptions = {},
): PlacedSpecies[] {
  const {
    density = 1,
    shares = {},
    form = "place",
    season = "autumn",
    grows = () => true,
    single = {},
    instead = (asset, place) => ({ asset, place }),
  } = options;
  const places = placeTrees(count, seed, density);
  const placed = new Map<TreeAsset, Placement[]>(assets.map((asset) => [asset, []]));
  plant(assets.filter(grows), places, shares, form).forEach((chosen, k) => {
    if (!chosen) return;
    const { asset, place } = instead(chosen, places[k]);
    placed.get(asset)?.push(place);
  });
  return placedSpecies(assets, (asset) => placed.get(asset) ?? [], single, season);
}

/** Beside the axis of a view a tree may stand this far, relative to its distance along the axis, to be in the picture, also of an upright phone. */
const MIDDLE_SHARE = 0.25;

/** Trees in the centre of a large forest, which come first: placing a hundred thousand takes half a second. */
export const CENTRE_TREES = 2000;

/** The tree of which an instance of `placeForest` is nearest in the middle of the picture; null without any. */
export function firstInView(
  assets: readonly TreeAsset[],
  count: number,
  seed: number,
  { density = 1, shares = {}, form = "place" }: PlacementOptions,
  { eye, target }: Viewpoint,
): TreeAsset | null {
  const places = placeTrees(Math.min(count, CENTRE_TREES), seed, density);
  const [x, z] = [target.x - eye.x, target.z - eye.z];
  const length_m = Math.hypot(x, z) || 1;
  let first: TreeAsset | null = null;
  let nearest_m = Number.POSITIVE_INFINITY;
  plant(assets, places, shares, form).forEach((asset, k) => {
    const [dx, dz] = [places[k].x_m - eye.x, places[k].z_m - eye.z];
    const along_m = (dx * x + dz * z) / length_m;
    const beside_m = Math.abs(dx * z - dz * x) / length_m;
    if (!asset?.hasTable || beside_m > MIDDLE_SHARE * along_m || along_m >= nearest_m) return;
    nearest_m = along_m;
    first = asset;
  });
  return first;
}

/** The trees at these places, and the single ones, by species; those whose model is not loaded are left out. */
export function placedSpecies(
  assets: readonly TreeAsset[],
  placesOf: (asset: TreeAsset) => Placement[],
  single: Readonly<Record<string, Placement>>,
  season: Season,
): PlacedSpecies[] {
  return assets.flatMap((asset) => {
    const own = placesOf(asset);
    if (single[asset.id]) own.push(single[asset.id]);
    if (!asset.model || own.length === 0) return [];
    const tint = (treeId: number) => leafTint(asset.species, treeId, season);
    const instances = createInstanceData(own, groundHeight_m, tint, asset.model.leans);
    return [{ asset, model: asset.model, motion: asset.motion, instances }];
  });
}

/**
 * Large forests are selected in several turns while the camera moves, because a frame in which all their trees are takes
 * too long, and uploads too much.
 */
const TURN_TREES = 20_000;
const MOST_TURNS = 3;

/** Share of a tree's height below its crown, and of the largest reach that the crown fills. */
const TRUNK_HEIGHT_SHARE = 0.26;
const CROWN_FILL_SHARE = 0.8;

function writeCrown(
  crowns: Float32Array,
  at: number,
  data: Float32Array,
  tree: number,
  { height_m, radius_m, evergreen }: TreeModel,
): void {
  const scale = data[tree + 6];
  const tall = 0.5 * (1 - TRUNK_HEIGHT_SHARE) * height_m * scale;
  const middle = data[tree + 1] + TRUNK_HEIGHT_SHARE * height_m * scale + tall;
  crowns.set([data[tree], middle, data[tree + 2], CROWN_FILL_SHARE * radius_m * scale, tall], at);
  crowns.set(data.subarray(tree + 8, tree + 11), at + 5);
  crowns[at + 8] = evergreen ? 0 : 1;
}

export class Forest {
  readonly group = new Group();
  moving: MovingGroup[] = [];
  private all: MovingGroup[] = [];
  /** Made for a placement that is not shown yet. */
  private prepared: SpeciesForest<TableMotion>[] = [];
  private frozen = false;
  private leafless = false;
  private turn = 0;

  /** `options` apply to the next placement. */
  constructor(
    public options: SpeciesOptions,
    private readonly impostors: ImpostorLibrary | null = null,
  ) {}

  /** Makes the species of a placement that is to be shown; returns those that are new. */
  prepare(placed: readonly PlacedSpecies[]): Group[] {
    this.forgetPrepared();
    const { all } = this;
    const lacking = placed.filter((group) => !all.some(({ forest }) => this.serves(forest, group)));
    this.prepared = lacking.map((group) => this.createSpecies(group));
    return this.prepared.map(({ group }) => group);
  }

  private forgetPrepared(): void {
    const { all, prepared } = this;
    for (const forest of prepared) if (!all.some((shown) => shown.forest === forest)) forest.dispose();
    this.prepared = [];
  }

  /** Shows a placement; species that stay keep their meshes and textures on the GPU. */
  show(placed: readonly PlacedSpecies[]): void {
    const before = this.all;
    const made = [...before.map(({ forest }) => forest), ...this.prepared];
    this.all = placed.map((group) => {
      const old = made.find((forest) => this.serves(forest, group));
      old?.setInstances(group.instances);
      return { asset: group.asset, forest: old ?? this.createSpecies(group) };
    });
    for (const { forest } of this.all) if (forest.group.parent === null) this.present(forest);
    this.forgetPrepared();
    const kept = new Set(this.all.map(({ forest }) => forest));
    for (const { forest } of before) if (!kept.has(forest)) forest.dispose();
    this.freeModels(before);
    this.moving = this.all.filter(({ forest }) => forest.motion);
  }

  /** Frees the GPU resources of models that are no longer drawn. */
  private freeModels(before: readonly MovingGroup[]): void {
    const used = new Set(this.all.map(({ forest }) => forest.model));
    for (const { model } of before.map(({ forest }) => forest)) if (!used.has(model)) disposeModel(model);
  }

  private serves(forest: SpeciesForest<TableMotion>, { model, motion }: PlacedSpecies): boolean {
    return forest.model === model && forest.motion === motion && forest.options === this.options;
  }

  private createSpecies({ model, motion, instances }: PlacedSpecies): SpeciesForest<TableMotion> {
    const forest = new SpeciesForest(model, motion, instances, this.options);
    forest.leafless = this.leafless;
    return forest;
  }

  /** Adds a species to the picture. */
  private present(forest: SpeciesForest<TableMotion>): void {
    const { model, motion } = forest;
    if (this.frozen) forest.freeze(true);
    forest.leafless = this.leafless;
    forest.cards = motion && (this.impostors?.cardsFor(model, this.group, motion) ?? null);
    this.group.add(forest.group);
  }

  /** Sets the season of all trees, including later placements; call `select` afterwards. */
  setSeason(season: Season): void {
    this.leafless = season === "winter";
    for (const { asset, forest } of this.all) {
      setTints(forest.instances, (treeId) => leafTint(asset.species, treeId, season));
      forest.leafless = this.leafless;
    }
  }

  /** In how many turns the trees are selected while the camera moves. */
  get turns(): number {
    const trees = this.all.reduce((sum, { forest }) => sum + forest.instances.count, 0);
    return Math.min(MOST_TURNS, Math.max(1, Math.ceil(trees / TURN_TREES)));
  }

  /** Selects what is drawn of all trees in this view, or in one of so many turns of a part of the species. */
  select(view: View, turns = 1): void {
    this.turn = (this.turn + 1) % turns;
    const largestFirst = this.all.toSorted((a, b) => b.forest.instances.count - a.forest.instances.count);
    for (const [rank, { forest }] of largestFirst.entries())
      if (rank % turns === this.turn) forest.select(view);
  }

  renderNodes(renderer: WebGLRenderer): void {
    for (const { forest } of this.moving) forest.renderNodes(renderer);
  }

  /** Draws all trees without motion, or moving again. */
  freeze(frozen: boolean): void {
    this.frozen = frozen;
    for (const { forest } of this.moving) forest.freeze(frozen);
  }

  /** The first tree hit by a ray, in the newest poses. */
  pick(ray: Ray, poses: readonly Float32Array[]): PickedTree | null {
    const groups = this.all.map((group) => ({
      ...group.forest.pickable,
      poses: poses[this.moving.indexOf(group)] ?? null,
    }));
    const hit = pickTree(groups, ray);
    if (!hit) return null;
    return { ...this.treeAt(this.all[hit.group], hit.tree), distance_m: hit.distance_m };
  }

  /** The tree of a place, by its id; null if there is none. */
  at(id: number): PickedTree | null {
    for (const group of this.all) {
      const tree = group.forest.instances.ids.indexOf(id);
      if (tree >= 0) return { ...this.treeAt(group, tree), distance_m: 0 };
    }
    return null;
  }

  private treeAt({ asset, forest }: MovingGroup, tree: number): Omit<PickedTree, "distance_m"> {
    const [x, y, z, , , , scale] = forest.instances.data.subarray(tree * INSTANCE_FLOATS);
    return {
      id: forest.instances.ids[tree],
      treeId: asset.id,
      species: asset.species,
      position: { x, y, z },
      height_m: forest.model.height_m * scale,
      radius_m: forest.model.radius_m * scale,
    };
  }

  /** The crowns of all trees. */
  get crowns(): Crowns {
    const crowns = new Float32Array(
      CROWN_FLOATS * this.all.reduce((sum, { forest }) => sum + forest.instances.count, 0),
    );
    let at = 0;
    for (const { forest } of this.all) {
      for (let tree = 0; tree < forest.instances.count; tree++, at += CROWN_FLOATS) {
        writeCrown(crowns, at, forest.instances.data, tree * INSTANCE_FLOATS, forest.model);
      }
    }
    return crowns;
  }

  /** The tree of a kind with the largest id, which is the one in the clearing if there is one; null if none is drawn. */
  last(treeId: string): (Omit<PickedTree, "distance_m"> & { readonly moves: boolean }) | null {
    const group = this.all.find(({ asset }) => asset.id === treeId);
    if (!group) return null;
    const { instances, motion } = group.forest;
    const tree = instances.ids.reduce((last, id, at, ids) => (id > ids[last] ? at : last), 0);
    return { ...this.treeAt(group, tree), moves: motion !== null };
  }

  /** Number of trees of a kind. */
  count(treeId: string): number {
    const groups = this.all.filter(({ asset }) => asset.id === treeId);
    return groups.reduce((sum, { forest }) => sum + forest.instances.count, 0);
  }

  /** Whether this tree still exists. */
  has({ treeId, id }: { treeId: string; id: number }): boolean {
    return this.all.some(({ asset, forest }) => asset.id === treeId && forest.instances.ids.includes(id));
  }

  get triangles(): number {
    return this.all.reduce((sum, { forest }) => sum + forest.triangles, 0);
  }

  /** Numbers of trees that move and that do not; of these, `loading` have a table that is being fetched. */
  get trees(): { moving: number; still: number; loading: number } {
    const count = (groups: readonly MovingGroup[]) =>
      groups.reduce((sum, { forest }) => sum + forest.instances.count, 0);
    const still = this.all.filter(({ forest }) => !forest.motion);
    return {
      moving: count(this.moving),
      still: count(still),
      loading: count(still.filter(({ asset }) => asset.hasTable)),
    };
  }

  clear(): void {
    this.forgetPrepared();
    const before = this.all;
    for (const { forest } of before) forest.dispose();
    this.all = [];
    this.freeModels(before);
    this.moving = [];
  }
}
