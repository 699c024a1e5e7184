/** Which trees to grow for the stems of an inventory, and which of them stands for a tree of a size. Pure. */

import type { Stem } from "galewood/inventory";
import type { TreeAsset } from "./forest";
import type { Form, FormChoice } from "./forms";

/** What a tree is grown as. */
export interface Size {
  readonly species: string;
  readonly form: Form;
  readonly height_m: number;
  /** Diameter at 1.3 m; null: in proportion to the height. */
  readonly dbh_cm: number | null;
}

/** A tree to grow: its branches follow from the seed. */
export interface Order extends Size {
  readonly seed: number;
}

/** A tree that the server has grown. */
export interface Individual extends Size {
  /** Its id on the server. */
  readonly id: string;
}

/** Most trees that are grown for one forest: a server holds at most 64 tables in one, and 24 are of built-in trees. */
export const MOST_OWN_TREES = 40;

/** Sizes are rounded, so that inventories that differ by less than can be seen share trees. */
const HEIGHT_STEP_M = 0.1;
const DBH_STEP_CM = 0.5;

const rounded = (value: number, step: number): number => Number((Math.round(value / step) * step).toFixed(1));

/** The form in which a stem is planted. */
export const formOf = ({ slender }: Stem, form: FormChoice): Form => {
  if (form !== "place") return form;
  return slender ? "forest" : "open";
};

/** The size of a stem in the form in which it is planted. */
export const sizeOfStem = (stem: Stem, form: FormChoice): Size => ({
  species: stem.builtin,
  form: formOf(stem, form),
  height_m: stem.height_m,
  dbh_cm: stem.dbh_cm ?? null,
});

const kindOfSize = ({ species, form }: Size): string => `${species} ${form}`;

function grouped<T>(all: readonly T[], keyOf: (one: T) => string): Map<string, T[]> {
  const groups = new Map<string, T[]>();
  for (const one of all) {
    const key = keyOf(one);
    const group = groups.get(key);
    if (group) group.push(one);
    else groups.set(key, [one]);
  }
  return groups;
}

/** The stems by species and form, most stems first. */
function kindsOfStems(stems: readonly Stem[], form: FormChoice): Size[][] {
  const kinds = grouped(
    stems.map((stem) => sizeOfStem(stem, form)),
    kindOfSize,
  );
  return [...kinds.values()].sort((a, b) => b.length - a.length);
}

/**
 * How many of `budget` trees each of these groups gets, so that the largest number of stems per tree is least: each one
 * goes where a tree stands for most stems. While there are fewer than groups, the largest groups get one each.
 */
export function spread(sizes: readonly number[], budget: number): number[] {
  const counts = sizes.map(() => 0);
  for (let given = 0; given < budget; given++) {
    const perTree = sizes.map((size, k) => (counts[k] < size ? size / counts[k] : 0));
    const most = Math.max(...perTree);
    const candidates = perTree.flatMap((stems, k) => (stems === most ? [k] : []));
    if (most <= 0) break;
    counts[candidates.reduce((best, k) => (sizes[k] > sizes[best] ? k : best))]++;
  }
  return counts;
}

/** The trees to grow for these stems: of each species and form, those in the middle of equal shares of its stems. */
export function treesToGrow(stems: readonly Stem[], budget: number, form: FormChoice): Order[] {
  const kinds = kindsOfStems(stems, form);
  const counts = spread(
    kinds.map(({ length }) => length),
    budget,
  );
  return kinds.flatMap((kind, k) => {
    const bySize = kind.toSorted((a, b) => a.height_m - b.height_m || (a.dbh_cm ?? 0) - (b.dbh_cm ?? 0));
    return Array.from({ length: counts[k] }, (_, at) =>
      orderOf(bySize[Math.floor(((at + 0.5) * bySize.length) / counts[k])], at + 1),
    );
  });
}

/** The tree to grow for a size, which is rounded. */
export const orderOf = ({ species, form, height_m, dbh_cm }: Size, seed: number): Order => ({
  species,
  form,
  seed,
  height_m: rounded(height_m, HEIGHT_STEP_M),
  dbh_cm: dbh_cm ? rounded(dbh_cm, DBH_STEP_CM) : null,
});

/** How far a size is from that of a tree: ratios of heights and of diameters, where both are known. */
export function distance(wanted: Pick<Size, "height_m" | "dbh_cm">, tree: Size): number {
  const tall = Math.log(wanted.height_m / tree.height_m);
  const thick = wanted.dbh_cm && tree.dbh_cm ? Math.log(wanted.dbh_cm / tree.dbh_cm) : 0;
  return Math.hypot(tall, thick);
}

/** A function that gives the tree of its species and form that is nearest to a size; null without one. */
export function nearestIndividual(individuals: readonly Individual[]) {
  const kinds = grouped(individuals, kindOfSize);
  return (wanted: Size): Individual | null => {
    let [best, least] = [null as Individual | null, Number.POSITIVE_INFINITY];
    for (const tree of kinds.get(kindOfSize(wanted)) ?? []) {
      const away = distance(wanted, tree);
      if (away < least) [best, least] = [tree, away];
    }
    return best;
  };
}

/**
 * The individuals that are loaded, once none is still loading: the forest changes its trees at once. What could not be
 * loaded is left out.
 */
export function arrivedOf(
  individuals: readonly Individual[],
  assets: readonly TreeAsset[],
): readonly Individual[] {
  const byId = new Map(assets.map((asset) => [asset.id, asset]));
  const found = individuals.map((tree) => ({ tree, asset: byId.get(tree.id) }));
  const loads = found.some(({ asset }) => asset?.hasTable && !(asset.model && asset.motion));
  return loads ? [] : found.flatMap(({ tree, asset }) => (asset?.model && asset.motion ? [tree] : []));
}
