/** What the reader of an inventory assumed, in sentences. Twin: precompute/galewood/inventory/notes.py. */
import { type Columns, isGeographic } from "./columns";
import type { Substitute } from "./report";
import { matchSpecies } from "./species";

export function notesOf(
  columns: Columns,
  units: Readonly<Record<string, string>>,
  counts: { readonly estimated: number; readonly formless: number; readonly stems: number },
): string[] {
  const { estimated, formless, stems } = counts;
  const notes: string[] = [];
  if (isGeographic(columns)) notes.push("Longitudes and latitudes (WGS 84) were projected to metres.");
  for (const [what, name] of [
    ["dbh", "diameters"],
    ["girth", "circumferences"],
  ] as const) {
    if (columns.units[what] === "") notes.push(`No unit of the ${name} was found: ${units[what]} fits them.`);
  }
  if (columns.units.height === "") notes.push("No unit of the heights was found: m is assumed.");
  if (estimated > 0) {
    notes.push(`${estimated} of ${stems} heights were missing and estimated from the diameter.`);
  }
  if (formless > 0) {
    notes.push(
      `${formless} of ${stems} trees lack a height or a diameter, which decide between the open-grown and the slender form: the density of the plot decides.`,
    );
  }
  if (columns.index.species === undefined && columns.index.genus === undefined) {
    notes.push("There is no column of species: trees below 8 m are apricots, the others maples.");
  }
  return notes;
}

/** Names that have no tree of their genus, the most frequent first. */
export function substitutesOf(stems: readonly { species: string; height_m: number }[]): Substitute[] {
  const counts = new Map<string, Substitute>();
  for (const { species, height_m } of stems) {
    const { builtin, genus, same } = matchSpecies(species, height_m);
    if (same) continue;
    const key = JSON.stringify([species, builtin]);
    counts.set(key, { name: species, builtin, genus, stems: (counts.get(key)?.stems ?? 0) + 1 });
  }
  return [...counts.values()].sort((a, b) => b.stems - a.stems);
}
