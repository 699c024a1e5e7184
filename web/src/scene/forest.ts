/** The forest on screen: one SpeciesForest per species, planted over shared places. */
import { Group, type WebGLRenderer } from "three";
import type { Ray } from "../core/math/groundRay";
import type { TableMotion } from "../worker/protocol";
import { groundHeight_m } from "./ground/landscape";
import { chooseSpecies, placeTrees } from "./placement";
import { leafTint } from "./season/palette";
import type { Season } from "./season/season";
import type { View } from "./trees/drawList";
import { disposeModel, type TreeModel } from "./trees/mesh/treeMesh";
import { SpeciesForest, type SpeciesOptions } from "./trees/speciesForest";
import { INSTANCE_FLOATS, makeStand, retint, type Stand } from "./trees/stand";
import { pickTree } from "./trees/treePick";

/** A species that the forest may plant; without a model its places stay free. */
export interface Grower {
  readonly id: string;
  readonly species: string | null;
  model: TreeModel | null;
  /** null: the table is not in yet, the trees stand still and grey. */
  motion: TableMotion | null;
}

/** One species of a planting. */
export interface PlantedGroup {
  readonly grower: Grower;
  readonly model: TreeModel;
  readonly motion: TableMotion | null;
  readonly stand: Stand;
}

/** One moving group, in the order in which worker and server know them. */
export interface MovingGroup {
  readonly grower: Grower;
  readonly forest: SpeciesForest;
}

/** A tree that was picked. */
export interface PickedTree {
  /** Identity of its place: stays when other trees come and go. */
  readonly id: number;
  /** The server's tree (species or upload) that grows there. */
  readonly treeId: string;
  readonly species: string | null;
  readonly position: { x: number; y: number; z: number };
  readonly height_m: number;
  readonly radius_m: number;
  /** From the eye to where it was hit. */
  readonly distance_m: number;
}

export interface PlantingOptions {
  /** 1 is the usual one. */
  readonly density?: number;
  /** How common each species is beside the others, by id; 1 if not named. */
  readonly shares?: Readonly<Record<string, number>>;
  readonly season?: Season;
}

/** Which tree stands where. Places depend on seed and number only: trees that were there stay where they were. */
export function planForest(
  growers: readonly Grower[],
  count: number,
  seed: number,
  { density = 1, shares = {}, season = "autumn" }: PlantingOptions = {},
): PlantedGroup[] {
  const places = placeTrees(count, seed, density);
  const choice = chooseSpecies(
    places,
    growers.map((grower) => grower.id),
    shares,
  );
  return growers.flatMap((grower, k) => {
    const own = places.filter((_, i) => choice[i] === k);
    if (!grower.model || own.length === 0) return [];
    const stand = makeStand(own, groundHeight_m, (treeId) => leafTint(grower.species, treeId, season));
    return [{ grower, model: grower.model, motion: grower.motion, stand }];
  });
}

export class Forest {
  readonly group = new Group();
  moving: MovingGroup[] = [];
  private all: MovingGroup[] = [];
  private frozen = false;
  private leafless = false;

  /** `options` hold for the next planting. */
  constructor(public options: SpeciesOptions) {}

  /** Shows a planting; species that were there before keep their meshes and textures on the graphics card. */
  show(planted: readonly PlantedGroup[]): void {
    const before = this.all;
    this.all = planted.map((group) => {
      const old = before.find(({ forest }) => this.serves(forest, group));
      if (old?.forest.replant(group.stand)) return { grower: group.grower, forest: old.forest };
      return { grower: group.grower, forest: this.grow(group) };
    });
    const kept = new Set(this.all.map(({ forest }) => forest));
    for (const { forest } of before) if (!kept.has(forest)) forest.dispose();
    this.freeModels(before);
    this.moving = this.all.filter(({ forest }) => forest.motion);
  }

  /** What no tree is drawn with any longer need not stay on the graphics card. */
  private freeModels(before: readonly MovingGroup[]): void {
    const used = new Set(this.all.map(({ forest }) => forest.model));
    for (const { model } of before.map(({ forest }) => forest)) if (!used.has(model)) disposeModel(model);
  }

  private serves(forest: SpeciesForest, { model, motion }: PlantedGroup): boolean {
    return forest.model === model && forest.motion === motion && forest.options === this.options;
  }

  private grow({ model, motion, stand }: PlantedGroup): SpeciesForest {
    const forest = new SpeciesForest(model, motion, stand, this.options);
    if (this.frozen) forest.freeze(true);
    forest.leafless = this.leafless;
    this.group.add(forest.group);
    return forest;
  }

  /** Dresses all trees for a season, those of later plantings too; select anew afterwards. */
  setSeason(season: Season): void {
    this.leafless = season === "winter";
    for (const { grower, forest } of this.all) {
      retint(forest.stand, (treeId) => leafTint(grower.species, treeId, season));
      forest.leafless = this.leafless;
    }
  }

  select(view: View): void {
    for (const { forest } of this.all) forest.select(view);
  }

  renderNodes(renderer: WebGLRenderer): void {
    for (const { forest } of this.moving) forest.renderNodes(renderer);
  }

  /** Draws all trees without motion, or moving again. */
  freeze(frozen: boolean): void {
    this.frozen = frozen;
    for (const { forest } of this.moving) forest.freeze(frozen);
  }

  /** The tree that a ray meets first, where the newest poses of the moving groups have it. */
  pick(ray: Ray, poses: readonly Float32Array[]): PickedTree | null {
    const groups = this.all.map((group) => ({
      ...group.forest.pickable,
      poses: poses[this.moving.indexOf(group)] ?? null,
    }));
    const hit = pickTree(groups, ray);
    if (!hit) return null;
    const { grower, forest } = this.all[hit.group];
    const [x, y, z, , , , scale] = forest.stand.data.subarray(hit.tree * INSTANCE_FLOATS);
    return {
      id: forest.stand.ids[hit.tree],
      treeId: grower.id,
      species: grower.species,
      position: { x, y, z },
      height_m: forest.model.height_m * scale,
      radius_m: forest.model.radius_m * scale,
      distance_m: hit.distance_m,
    };
  }

  /** Whether this tree still stands. */
  has({ treeId, id }: { treeId: string; id: number }): boolean {
    return this.all.some(({ grower, forest }) => grower.id === treeId && forest.stand.ids.includes(id));
  }

  get triangles(): number {
    return this.all.reduce((sum, { forest }) => sum + forest.triangles, 0);
  }

  get trees(): { moving: number; still: number } {
    const moving = this.moving.reduce((sum, { forest }) => sum + forest.stand.count, 0);
    return { moving, still: this.all.reduce((sum, { forest }) => sum + forest.stand.count, 0) - moving };
  }

  clear(): void {
    const before = this.all;
    for (const { forest } of before) forest.dispose();
    this.all = [];
    this.freeModels(before);
    this.moving = [];
  }
}
