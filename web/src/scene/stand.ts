/** A forest from an inventory: every stem is a tree of its species, at its place and as tall as measured. Pure. */
import { SCALES, type Stem } from "galewood/inventory";
import { hashUnit } from "galewood/random";
import type { Placement } from "galewood/trees";
import type { TreeAsset } from "./forest";
import { type FormChoice, formAt, kindsOf } from "./forms";
import { arrivedOf, formOf, type Individual, nearestIndividual, sizeOfStem } from "./individuals";
import { FOREST_CENTRE } from "./placement";

export interface StandOptions {
  readonly form: FormChoice;
  /** The upload that has the name of a species; null if none has. */
  named(species: string): string | null;
  /** Trees that were grown for these stems. */
  readonly individuals?: readonly Individual[];
}

/** Ids of other places are smaller (placement.ts, clearing.ts). */
const FIRST_ID = 2 ** 25;

/** Which stem of an inventory a tree is, by the id of its place; null if it is none. */
export const stemOf = (id: number): number | null => (id >= FIRST_ID ? id - FIRST_ID : null);

/** The id of the place of a stem. */
export const idOfStem = (index: number): number => FIRST_ID + index;

/** Where a stem stands: the middle of the plot is the middle of the forest; north is up, away from the first view. */
const placeOf = (stem: Stem, index: number, height_m: number): Placement => ({
  id: idOfStem(index),
  x_m: FOREST_CENTRE.x_m + stem.east_m,
  z_m: FOREST_CENTRE.z_m - stem.north_m,
  yaw_rad: 2 * Math.PI * hashUnit(index, 1),
  scale: Math.min(SCALES.most, Math.max(SCALES.least, stem.height_m / height_m)),
});

/** The places of each tree of a stand; stems whose tree is not loaded yet are left out. */
export function placeStand(
  assets: readonly TreeAsset[],
  stems: readonly Stem[],
  options: StandOptions,
): Map<TreeAsset, Placement[]> {
  const tree = treeChooser(assets, options);
  const places = new Map<TreeAsset, Placement[]>();
  stems.forEach((stem, index) => {
    const asset = tree(stem);
    if (!asset?.model) return;
    const own = places.get(asset) ?? [];
    own.push(placeOf(stem, index, asset.model.height_m));
    places.set(asset, own);
  });
  return places;
}

function treeChooser(assets: readonly TreeAsset[], { form, named, individuals = [] }: StandOptions) {
  const nearest = nearestIndividual(arrivedOf(individuals, assets));
  const kinds = kindsOf(assets.filter(({ builtin }) => builtin));
  const bySpecies = new Map(kinds.map((kind) => [(kind.open ?? kind.forest)?.species, kind]));
  const byId = new Map(assets.map((asset) => [asset.id, asset]));
  const uploads = new Map<string, TreeAsset | null>();
  return (stem: Stem): TreeAsset | null => {
    let own = uploads.get(stem.species);
    if (own === undefined) {
      own = byId.get(named(stem.species) ?? "") ?? null;
      uploads.set(stem.species, own);
    }
    if (own) return own;
    const grown = byId.get(nearest(sizeOfStem(stem, form))?.id ?? "");
    if (grown) return grown;
    // a server may have only some of the species
    const kind = bySpecies.get(stem.builtin) ?? kinds[0];
    return kind ? formAt(kind, formOf(stem, form) === "open") : null;
  };
}

/** Extent of a stand. */
export interface StandSize {
  readonly width_m: number;
  readonly depth_m: number;
  readonly highest_m: number;
}

/** The extent of stems, which stand about the middle of their plot. */
export function extentOf(stems: readonly Stem[]): StandSize {
  const extent = { west: 0, east: 0, south: 0, north: 0, highest_m: 0 };
  for (const { east_m, north_m, height_m } of stems) {
    extent.west = Math.min(extent.west, east_m);
    extent.east = Math.max(extent.east, east_m);
    extent.south = Math.min(extent.south, north_m);
    extent.north = Math.max(extent.north, north_m);
    extent.highest_m = Math.max(extent.highest_m, height_m);
  }
  const { west, east, south, north, highest_m } = extent;
  return { width_m: east - west, depth_m: north - south, highest_m };
}

/** Half the vertical angle of view. */
const HALF_VIEW = (23 * Math.PI) / 180;
/** Width of the picture that the stand may take, relative to that at its near edge; instruments cover the left. */
const IN_VIEW = 0.9;
const BESIDE_INSTRUMENTS = 1.15;
const WIDE_ASPECT_RATIO = 1.2;
const FARTHEST_M = 250;
/** Cards cover the middle of a narrow picture: the stand is this much below it, as a tangent. */
const BELOW_CARDS = 0.12;

/** Eye and target, with heights above the ground, that show a stand from the south and above its crowns. */
export function standView({ width_m, depth_m, highest_m }: StandSize, aspect: number) {
  const wide = aspect > WIDE_ASPECT_RATIO;
  const room = wide ? BESIDE_INSTRUMENTS : IN_VIEW;
  const across_m = (0.5 * room * width_m + 4) / (Math.tan(HALF_VIEW) * aspect);
  const left_m = wide ? 0.12 * width_m : 0;
  const away_m = Math.min(FARTHEST_M, Math.max(across_m, 1.4 * highest_m) + 0.5 * depth_m);
  const eye = {
    x: FOREST_CENTRE.x_m - left_m + 0.1 * width_m,
    above: 0.75 * highest_m + 0.1 * away_m,
    z: FOREST_CENTRE.z_m + away_m,
  };
  const above = 0.45 * highest_m + (wide ? 0 : BELOW_CARDS * away_m);
  return { eye, target: { x: FOREST_CENTRE.x_m - left_m, above, z: FOREST_CENTRE.z_m } };
}
