/**
 * Places of the background forest: those that the simulated forest would take next, so that it goes on beyond its edge with
 * the same density, species and trees. Far from the eye, where one hides the other, fewer are drawn. Pure.
 */
import { hashUnit } from "galewood/random";
import type { Placement } from "galewood/trees";
import { type Grown, kindsOf } from "../forms";
import { glade } from "../ground/landscape";
import { chooseSpecies, isWood, placeAt, reach_m, SPACING_M } from "../placement";
import type { Quality } from "../quality";

/** The background forest ends here, m from the centre. */
export const REACH_M = 430;

export interface Thinning {
  /** Up to this distance from the eye all trees are drawn, m. */
  readonly full_m: number;
  /** Smallest share of the trees that are drawn. */
  readonly least: number;
}

export const THINNING_LEVELS: Record<Quality, Thinning> = {
  low: { full_m: 80, least: 0.16 },
  medium: { full_m: 130, least: 0.3 },
  high: { full_m: 190, least: 0.45 },
};

/** Share of the trees that are drawn at a distance from the eye. */
export function shareDrawn(distance_m: number, { full_m, least }: Thinning): number {
  return Math.max(least, Math.min(1, full_m / Math.max(distance_m, 1e-3)));
}

/** Where few trees are drawn, each is up to this much larger, so that the canopy stays nearly closed. */
const MOST_GROWTH = 1.22;
export const growthAt = (share: number) => Math.min(MOST_GROWTH, share ** -0.25);

/** A tree is drawn while its rank, uniform in [0, 1), is below the share of its distance. */
export const rankOf = (place: Placement) => hashUnit(197, place.id);

/** The places beyond `edge_m`, the distance of the outermost simulated tree. */
export function farPlaces(edge_m: number, seed: number, density: number): Placement[] {
  const spacing_m = SPACING_M / Math.sqrt(density);
  const columns = Math.ceil(REACH_M / spacing_m) + 1;
  const rows = Math.ceil(REACH_M / (0.9 * spacing_m)) + 1;
  const places: Placement[] = [];
  for (let row = -rows; row <= rows; row++) {
    const z = row * spacing_m * 0.9;
    for (let column = -columns; column <= columns; column++) {
      const about_m = Math.hypot(column * spacing_m, z);
      if (about_m < edge_m - 2 * spacing_m || about_m > REACH_M) continue;
      // Of a dense forest as many are left out as of the usual one has no place.
      if (hashUnit(199, seed, column, row) >= 1 / Math.max(1, density)) continue;
      const place = placeAt(column, row, seed, spacing_m);
      if (reach_m(place) > edge_m && isWood(place)) places.push(place);
    }
  }
  return places;
}

/** Beside the glade, trees have grown in the open. */
const OPEN_GLADE = 0.06;

/**
 * Index of the tree at each place, -1 for none. Kinds are chosen as in the simulated forest; uploads stay out of the
 * background. If all built-in ones are excluded, they are used nevertheless.
 */
export function plantFar<Tree extends Grown>(
  trees: readonly Tree[],
  places: readonly Placement[],
  shares: Readonly<Record<string, number>>,
): Int32Array {
  const builtin = trees.filter((tree) => tree.builtin);
  const kinds = kindsOf(builtin);
  const some = kinds.some(({ id }) => (shares[id] ?? 1) > 0);
  const chosen = chooseSpecies(
    places,
    kinds.map(({ id }) => id),
    some ? shares : {},
  );
  return Int32Array.from(places, (place, i) => {
    const kind = kinds[chosen[i]];
    if (!kind) return -1;
    const { open, forest } = kind;
    const tree = glade(place.x_m, place.z_m) > OPEN_GLADE ? (open ?? forest) : (forest ?? open);
    return tree ? trees.indexOf(tree) : -1;
  });
}
