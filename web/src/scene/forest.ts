/** The forest on screen: one SpeciesForest per species, planted over shared places. */
import { Group, type WebGLRenderer } from "three";
import type { TableMotion } from "../worker/protocol";
import { groundHeight_m } from "./landscape";
import { leafTint } from "./palette";
import { chooseSpecies, type Place, placeTrees } from "./planting";
import { SpeciesForest, type SpeciesOptions } from "./speciesForest";
import { makeStand, type View } from "./stand";
import type { TreeModel } from "./treeMesh";

/** A species that the forest may plant; without a model its places stay free. */
export interface Grower {
  readonly id: string;
  readonly species: string | null;
  model: TreeModel | null;
  /** null: the table is not in yet, the trees stand still and grey. */
  motion: TableMotion | null;
}

/** One moving group, in the order in which worker and server know them. */
export interface MovingGroup {
  readonly grower: Grower;
  readonly forest: SpeciesForest;
}

export class Forest {
  readonly group = new Group();
  moving: MovingGroup[] = [];
  private all: SpeciesForest[] = [];

  /** `options` hold for the next planting. */
  constructor(public options: SpeciesOptions) {}

  /** Plants anew. Places depend on seed and number only, so trees that were there stay where they were. */
  plant(growers: readonly Grower[], count: number, seed: number): void {
    this.clear();
    const places = placeTrees(count, seed);
    const choice = chooseSpecies(
      places,
      growers.map((grower) => grower.id),
    );
    growers.forEach((grower, k) => {
      const own = places.filter((_, i) => choice[i] === k);
      if (grower.model && own.length > 0) this.add(grower, grower.model, own);
    });
  }

  private add(grower: Grower, model: TreeModel, places: readonly Place[]): void {
    const stand = makeStand(places, groundHeight_m, (treeId) => leafTint(grower.species, treeId));
    const forest = new SpeciesForest(model, grower.motion, stand, this.options);
    this.all.push(forest);
    if (grower.motion) this.moving.push({ grower, forest });
    this.group.add(forest.group);
  }

  select(view: View): void {
    for (const forest of this.all) forest.select(view);
  }

  renderNodes(renderer: WebGLRenderer): void {
    for (const { forest } of this.moving) forest.renderNodes(renderer);
  }

  get triangles(): number {
    return this.all.reduce((sum, forest) => sum + forest.triangles, 0);
  }

  get trees(): { moving: number; still: number } {
    const moving = this.moving.reduce((sum, { forest }) => sum + forest.stand.count, 0);
    return { moving, still: this.all.reduce((sum, forest) => sum + forest.stand.count, 0) - moving };
  }

  clear(): void {
    for (const forest of this.all) forest.dispose();
    this.all = [];
    this.moving = [];
  }
}
