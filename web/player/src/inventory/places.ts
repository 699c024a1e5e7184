/** Where the stems of an inventory stand, and which tree each of them is. Pure. */
import type { Place } from "../core/forest/forest";
import { hashUnit } from "../core/math/random";
import type { Inventory, Stem } from "./document";

/** Limits of the size of a tree relative to its model. */
export const SCALES = { least: 0.15, most: 4 } as const;

const placeOf = (
  { east_m, north_m, height_m }: Stem,
  index: number,
  model_m: number,
): Required<Omit<Place, "y_m">> => ({
  x_m: east_m,
  z_m: -north_m,
  yaw_rad: 2 * Math.PI * hashUnit(index, 1),
  scale: Math.min(SCALES.most, Math.max(SCALES.least, height_m / model_m)),
});

/**
 * The places of every kind of tree, about the middle of the plot: x to the east, z to the south. `heights_m`: heights of the
 * kinds (m), by their names. A stem is a tree with the name of its species as the file has it, else of the built-in species that stands
 * for it (`poplar`, `maple`, …), else of the first kind. Trees are scaled to the height of the stem.
 */
export function placesOf<Name extends string>(
  { stems }: Pick<Inventory, "stems">,
  heights_m: Readonly<Record<Name, number>>,
): Record<Name, Required<Omit<Place, "y_m">>[]> {
  const names = Object.keys(heights_m) as Name[];
  if (names.length === 0) throw new RangeError("expected at least one kind of tree");
  const known = new Map<string, Name>(names.map((name) => [name.toLowerCase(), name]));
  const places = Object.fromEntries(names.map((name) => [name, []])) as unknown as ReturnType<
    typeof placesOf<Name>
  >;
  for (const [index, stem] of stems.entries()) {
    const name = known.get(stem.species.toLowerCase()) ?? known.get(stem.builtin) ?? names[0];
    places[name].push(placeOf(stem, index, heights_m[name]));
  }
  return places;
}
