/** Seeded placement of trees, stable when trees or species are added. Pure. */
import { hashText, hashUnit, valueNoise } from "galewood/random";
import type { Placement } from "galewood/trees";
import { glade } from "./ground/landscape";

export const SPACING_M = 6.4;
/** The forest grows outwards from here, so that the initial camera looks into it. */
export const FOREST_CENTRE = { x_m: 0, z_m: -26 } as const;

const CELL_OFFSET = 512;

/** The height of a tree over that of its model, at a share (0..1) of the trees by height. */
export const scaleAt = (share: number): number => 0.78 + 0.5 * share ** 1.4;

/** The place of one cell of the lattice. */
export function placeAt(column: number, row: number, seed: number, spacing_m: number): Placement {
  const at = (channel: number) => hashUnit(seed, column, row, channel);
  return {
    id: (row + CELL_OFFSET) * 2 * CELL_OFFSET + column + CELL_OFFSET,
    x_m: FOREST_CENTRE.x_m + (column + 0.82 * (at(0) - 0.5) + (row & 1) * 0.5) * spacing_m,
    z_m: FOREST_CENTRE.z_m + (row + 0.82 * (at(1) - 0.5)) * spacing_m * 0.9,
    yaw_rad: at(2) * 2 * Math.PI,
    scale: scaleAt(at(3)),
  };
}

export const isWood = (place: Placement) => glade(place.x_m, place.z_m) < 0.5;
/** Distance of a place from the centre of the forest. */
export const reach_m = ({ x_m, z_m }: Pick<Placement, "x_m" | "z_m">) =>
  Math.hypot(x_m - FOREST_CENTRE.x_m, z_m - FOREST_CENTRE.z_m);

let placed: { readonly key: string; readonly places: readonly Placement[] } | null = null;

/**
 * The `count` places nearest to the centre of the forest, nearest first; `density` is relative to the default. The last ones
 * are kept, because a forest is planted again as each of its species arrives.
 */
export function placeTrees(count: number, seed: number, density = 1): readonly Placement[] {
  const key = `${count} ${seed} ${density}`;
  if (placed?.key !== key) placed = { key, places: newPlaces(count, seed, density) };
  return placed.places;
}

function newPlaces(count: number, seed: number, density: number): Placement[] {
  const spacing_m = SPACING_M / Math.sqrt(density);
  const cells = Math.ceil(Math.sqrt((count * 1.6) / Math.PI) + (5 * SPACING_M) / spacing_m);
  const wood: Placement[] = [];
  for (let row = -cells; row <= cells; row++) {
    for (let column = -cells; column <= cells; column++) {
      const place = placeAt(column, row, seed, spacing_m);
      if (isWood(place)) wood.push(place);
    }
  }
  return nearestFirst(wood.map(reach_m))
    .slice(0, count)
    .map((k) => wood[k]);
}

/** The order of numbers by size, equal ones as they are. A comparison that computes them takes seconds for large forests. */
function nearestFirst(far_m: readonly number[]): number[] {
  return far_m.map((_, k) => k).sort((a, b) => far_m[a] - far_m[b]);
}

/** Largest distance of a tree from the centre of the forest; `placements`: x, z, yaw, scale of each tree. */
export function woodReach_m(placements: readonly Float32Array[]): number {
  let most_m = 0;
  for (const placement of placements) {
    for (let at = 0; at < placement.length; at += 4) {
      most_m = Math.max(most_m, reach_m({ x_m: placement[at], z_m: placement[at + 1] }));
    }
  }
  return most_m;
}

/** Affinity of a species for a place: large groves with stray trees. Independent of the other species. */
function liking(place: Placement, species: string): number {
  const seed = hashText(species);
  const noise = valueNoise(place.x_m / 24, place.z_m / 24, seed) + 0.9 * hashUnit(seed, place.id);
  return Math.min(1, Math.max(1e-6, (noise + 1) / 2.9));
}

/**
 * Index of the species at each place, -1 for none. `shares`: relative frequency of each species, 1 if omitted, 0 to
 * exclude it. The largest of u^(1/share) wins, with u uniform: each species wins in proportion to its share.
 */
export function chooseSpecies(
  places: readonly Placement[],
  species: readonly string[],
  shares: Readonly<Record<string, number>> = {},
): Int32Array {
  const score = (place: Placement, name: string) => {
    const share = shares[name] ?? 1;
    return share > 0 ? liking(place, name) ** (1 / share) : -1;
  };
  return Int32Array.from(places, (place) => {
    let best = -1;
    let most = 0;
    species.forEach((name, k) => {
      const own = score(place, name);
      if (own <= most) return;
      most = own;
      best = k;
    });
    return best;
  });
}
