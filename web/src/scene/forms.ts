/** Forms of a species: open-grown trees stand at the edge of a forest, slender ones inside it. Pure. */

import type { Placement } from "galewood/trees";
import { glade } from "./ground/landscape";
import { chooseSpecies, reach_m } from "./placement";

export type Form = "open" | "forest";
/** Which form is planted: the one that suits each place, or the same everywhere. */
export const FORM_CHOICES = ["place", "open", "forest"] as const;
export type FormChoice = (typeof FORM_CHOICES)[number];

/** A tree of one form. */
export interface Grown {
  readonly id: string;
  readonly species: string | null;
  /** Only the forms of a built-in species belong together; an upload is a kind of its own. */
  readonly builtin: boolean;
  readonly form: Form;
}

/** What one chooses in the forest: a species with its forms, or an upload. */
export interface Kind<Tree extends Grown> {
  /** Id of the open-grown tree, if there is one. */
  readonly id: string;
  readonly open: Tree | null;
  readonly forest: Tree | null;
}

/** The kinds of these trees, in the order of their first trees. */
export function kindsOf<Tree extends Grown>(trees: readonly Tree[]): Kind<Tree>[] {
  const kinds = new Map<string, Kind<Tree>>();
  for (const tree of trees) {
    const id = kindOf(tree, trees);
    const kind = kinds.get(id) ?? { id, open: null, forest: null };
    kinds.set(id, { ...kind, [tree.form]: kind[tree.form] ?? tree });
  }
  return [...kinds.values()];
}

/** Id of the kind of a tree among these. */
export function kindOf(tree: Grown, trees: readonly Grown[]): string {
  if (tree.form === "open" || !tree.builtin) return tree.id;
  const open = trees.find(
    (other) => other.builtin && other.form === "open" && other.species === tree.species,
  );
  return open?.id ?? tree.species ?? tree.id;
}

/** From here inwards a tree is shaded by its neighbours on all sides: the outermost one or two rows are the edge. */
const EDGE_M = 8;
const DIRECTIONS_RAD = Array.from({ length: 8 }, (_, k) => (k * Math.PI) / 4);

/** Whether each tree stands at the edge of the planted area or of the glade, where it has grown in the open. */
export function atEdge(places: readonly Placement[]): boolean[] {
  const rim_m = places.reduce((most, place) => Math.max(most, reach_m(place)), 0) - EDGE_M;
  return places.map((place) => reach_m(place) >= rim_m || besideGlade(place));
}

function besideGlade({ x_m, z_m }: Placement): boolean {
  return DIRECTIONS_RAD.some(
    (angle) => glade(x_m + EDGE_M * Math.cos(angle), z_m + EDGE_M * Math.sin(angle)) >= 0.5,
  );
}

/** The form to plant: the one that suits the place, unless only the other one has a table. */
export function formAt<Tree extends Grown & { readonly hasTable: boolean }>(
  { open, forest }: Kind<Tree>,
  edge: boolean,
): Tree | null {
  const [suited, other] = edge ? [open, forest] : [forest, open];
  if (suited?.hasTable) return suited;
  return other?.hasTable ? other : (suited ?? other);
}

/** The tree to plant at each place; null where its kind is left out. Kinds are chosen as if each had one form. */
export function plant<Tree extends Grown & { readonly hasTable: boolean }>(
  trees: readonly Tree[],
  places: readonly Placement[],
  shares: Readonly<Record<string, number>>,
  form: FormChoice = "place",
): (Tree | null)[] {
  const kinds = kindsOf(trees);
  const chosen = chooseSpecies(
    places,
    kinds.map(({ id }) => id),
    shares,
  );
  const byPlace = form === "place" && kinds.some(({ open, forest }) => open && forest);
  const edge = byPlace ? atEdge(places) : places.map(() => form !== "forest");
  return Array.from(chosen, (kind, i) => (kind < 0 ? null : formAt(kinds[kind], edge[i])));
}
