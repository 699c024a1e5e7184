/** Which trees to grow for a generated forest, and where each of them stands. Pure. */

import type { Placement } from "galewood/trees";
import type { PlantedTree, TreeAsset } from "./forest";
import { type FormChoice, type Grown, plant } from "./forms";
import {
  arrivedOf,
  type Individual,
  nearestIndividual,
  type Order,
  orderOf,
  type Size,
  spread,
} from "./individuals";
import { placeTrees, scaleAt } from "./placement";

/** A tree that the server has from the start. */
export interface BuiltinTree extends Grown {
  readonly species: string;
  readonly height_m: number;
}

/** What determines where which built-in tree stands. */
export interface ForestLayout {
  readonly trees: number;
  readonly forestSeed: number;
  readonly density: number;
  readonly shares: Readonly<Record<string, number>>;
  readonly form: FormChoice;
}

/** Seeds of the trees of a forest: from its own seed times this on. */
const SEEDS_PER_FOREST = 1000;

/** The built-in tree at each place; places that stay empty are left out. */
function planted(builtin: readonly BuiltinTree[], layout: ForestLayout) {
  const places = placeTrees(layout.trees, layout.forestSeed, layout.density);
  const trees = builtin.map((tree) => ({ ...tree, hasTable: true }));
  const chosen = plant(trees, places, layout.shares, layout.form);
  return chosen.flatMap((tree, k) => (tree ? [{ tree, scale: places[k].scale }] : []));
}

/** The size of every tree of a generated forest. Its girth is in proportion to its height. */
export const sizesOfForest = (builtin: readonly BuiltinTree[], layout: ForestLayout): Size[] =>
  planted(builtin, layout).map(({ tree, scale }) => sizeOf(tree, scale * tree.height_m));

const sizeOf = ({ species, form }: BuiltinTree, height_m: number): Size => ({
  species,
  form,
  height_m,
  dbh_cm: null,
});

/**
 * The trees to grow for a generated forest. A species and form gets as many as its share of the trees says; their heights are
 * spread over the heights of a placement, by a sequence of which every beginning is spread. So a larger budget
 * only adds trees, and another number of trees in the forest changes few.
 */
export function treesOfForest(
  builtin: readonly BuiltinTree[],
  layout: ForestLayout,
  budget: number,
): Order[] {
  const counted = new Map<string, { readonly tree: BuiltinTree; count: number }>();
  for (const { tree } of planted(builtin, layout)) {
    const kind = counted.get(tree.id) ?? { tree, count: 0 };
    kind.count++;
    counted.set(tree.id, kind);
  }
  const kinds = [...counted.values()].sort((a, b) => b.count - a.count || (a.tree.id < b.tree.id ? -1 : 1));
  const budgets = spread(
    kinds.map(({ count }) => count),
    budget,
  );
  return kinds.flatMap(({ tree }, k) =>
    Array.from({ length: budgets[k] }, (_, at) =>
      orderOf(
        sizeOf(tree, scaleAt(spreadShare(at)) * tree.height_m),
        SEEDS_PER_FOREST * layout.forestSeed + at + 1,
      ),
    ),
  );
}

/** 1/2, 1/4, 3/4, 1/8, 5/8, ...: the binary digits of the number behind the point, in reverse (van der Corput). */
function spreadShare(at: number): number {
  let [share, digit] = [0, 0.5];
  for (let left = at + 1; left > 0; left >>= 1, digit /= 2) share += (left & 1) * digit;
  return share;
}

/**
 * A function that gives the individual to plant in place of a built-in tree, as tall as that would be: the nearest in
 * size, once all are loaded. Without one the built-in tree stays.
 */
export function individualsInstead(individuals: readonly Individual[], assets: readonly TreeAsset[]) {
  const nearest = nearestIndividual(arrivedOf(individuals, assets));
  const byId = new Map(assets.map((asset) => [asset.id, asset]));
  return (asset: TreeAsset, place: Placement): PlantedTree => {
    const { builtin, species, form, model } = asset;
    if (!builtin || !species || !model) return { asset, place };
    const height_m = place.scale * model.height_m;
    const own = byId.get(nearest({ species, form, height_m, dbh_cm: null })?.id ?? "");
    return own?.model
      ? { asset: own, place: { ...place, scale: height_m / own.model.height_m } }
      : { asset, place };
  };
}
