/** From the rows of an inventory to trees. Twin: precompute/galewood/inventory/reading.py. */
import { isComment, numberOf, quoted, type Row } from "../files/delimited";
import { type Columns, type Content, cellOf, findHeader, isGeographic, LENGTHS_M } from "./columns";
import { InventoryError, NoTree } from "./errors";
import { notesOf, substitutesOf } from "./notes";
import { placed, type Raw, spanOf } from "./placing";
import type { Report, Skipped } from "./report";
import { matchSpecies } from "./species";

export { InventoryError } from "./errors";
export { rowsOfGeojson } from "./geojson";
export type { Report, Skipped, Substitute } from "./report";

const LOWEST_M = 0.5;
const HIGHEST_M = 120;
const THICKEST_M = 12;
/** Height over diameter above which a tree has grown in a stand; assumed. */
const SLENDER = 65;
const MOST_LISTED = 20;

/** A tree of the inventory, placed relative to the middle of the plot. */
export interface Stem {
  readonly line: number;
  readonly east_m: number;
  readonly north_m: number;
  /** As in the file. */
  readonly species: string;
  /** The built-in species that stands for it. */
  readonly builtin: string;
  readonly height_m: number;
  /** Whether it has grown in a stand; null without a diameter. */
  readonly slender: boolean | null;
}

export interface Inventory {
  readonly stems: readonly Stem[];
  readonly report: Report;
}

type Units = Readonly<Record<string, string>>;

/** Reads the rows of a table, or of a GeoJSON file (`what`: "feature"). Throws InventoryError if none is a tree. */
export function readInventory(rows: readonly Row[], what: "line" | "feature" = "line"): Inventory {
  const { columns, first } = findHeader(rows);
  const units = unitsOf(columns, rows.slice(first));
  const data = rows.slice(first).filter((row) => !isComment(row));
  const raws: Raw[] = [];
  const faults: Skipped[] = [];
  for (const row of data) {
    try {
      raws.push(rawOf(columns, units, row));
    } catch (error) {
      if (!(error instanceof NoTree)) throw error;
      faults.push({ line: row.line, reason: error.message });
    }
  }
  if (raws.length === 0) {
    const why = faults.length > 0 ? ` (${what} ${faults[0].line}: ${faults[0].reason})` : "";
    throw new InventoryError(`no row describes a tree${why}`);
  }
  const { kept, far } = placed(raws, isGeographic(columns));
  const skipped = [...faults, ...far].sort((a, b) => a.line - b.line);
  return reported(kept, skipped, columns, units, data.length);
}

/** The unit of each length: as stated, else m for heights, and for diameters what fits their median. */
function unitsOf(columns: Columns, rows: readonly Row[]): Units {
  const units: Record<string, string> = { height: columns.units.height || "m" };
  for (const [what, usual_m] of [
    ["dbh", 0.3],
    ["girth", 1],
  ] as const) {
    if (columns.index[what] === undefined) continue;
    const values = rows
      .map((row) => numberOf(cellOf(columns, row, what)) ?? Number.NaN)
      .filter((value) => value > 0)
      .sort((a, b) => a - b);
    const typical = values[Math.floor(values.length / 2)] ?? 100 * usual_m;
    // a typical diameter is 0.3 m, 30 cm or 300 mm: the nearest by ratio
    const misfit = (unit: string) => Math.abs(Math.log((typical * LENGTHS_M[unit]) / usual_m));
    const best = ["cm", "mm", "m"].reduce((a, b) => (misfit(b) < misfit(a) ? b : a));
    units[what] = columns.units[what] || best;
  }
  if (!isGeographic(columns)) units.x = columns.units.x || "m";
  return units;
}

/** The tree of a row; throws NoTree with the reason if there is none. */
function rawOf(columns: Columns, units: Units, row: Row): Raw {
  const [x, y] = placeOf(columns, units, row);
  const height_m = lengthOf(columns, units, row, "height");
  let dbh_m = lengthOf(columns, units, row, "dbh");
  if (Number.isNaN(dbh_m)) dbh_m = lengthOf(columns, units, row, "girth") / Math.PI;
  if (Number.isNaN(height_m) && Number.isNaN(dbh_m)) throw new NoTree("neither height nor diameter");
  if (height_m < LOWEST_M || height_m > HIGHEST_M) {
    throw new NoTree(`a height of ${height_m.toFixed(1)} m is not between ${LOWEST_M} and ${HIGHEST_M} m`);
  }
  if (dbh_m <= 0 || dbh_m > THICKEST_M) {
    throw new NoTree(`a diameter of ${dbh_m.toFixed(2)} m is not between 0 and ${THICKEST_M} m`);
  }
  const species = `${cellOf(columns, row, "genus")} ${cellOf(columns, row, "species")}`.trim();
  return { line: row.line, x, y, species, height_m, dbh_m };
}

function placeOf(columns: Columns, units: Units, row: Row): [number, number] {
  const geographic = isGeographic(columns);
  const x = numberAt(columns, row, geographic ? "lon" : "x");
  const y = numberAt(columns, row, geographic ? "lat" : "y");
  if (Number.isNaN(x) || Number.isNaN(y)) throw new NoTree("no coordinates");
  if (!geographic) return [x * LENGTHS_M[units.x], y * LENGTHS_M[units.x]];
  if (Math.abs(x) > 180 || Math.abs(y) > 89) {
    throw new NoTree(`longitude ${x.toFixed(4)} and latitude ${y.toFixed(4)} are out of range`);
  }
  return [x, y];
}

const lengthOf = (columns: Columns, units: Units, row: Row, what: Content): number =>
  columns.index[what] === undefined ? Number.NaN : numberAt(columns, row, what) * LENGTHS_M[units[what]];

function numberAt(columns: Columns, row: Row, what: Content): number {
  const cell = cellOf(columns, row, what);
  const number = numberOf(cell);
  if (number === null) throw new NoTree(`${columns.names[what]}: ${quoted(cell)} is not a number`);
  return number;
}

/** Height of a tree of this diameter: 1.3 m + 30 m (1 − exp(−d / 0.28 m)); assumed, for closed stands. */
const estimatedHeight_m = (dbh_m: number): number => 1.3 + 30 * (1 - Math.exp(-dbh_m / 0.28));

function stemOf(raw: Raw): Stem {
  const unknown = Number.isNaN(raw.height_m);
  const height_m = unknown ? estimatedHeight_m(raw.dbh_m) : raw.height_m;
  return {
    line: raw.line,
    east_m: raw.x,
    north_m: raw.y,
    species: raw.species,
    builtin: matchSpecies(raw.species, height_m).builtin,
    height_m,
    slender: unknown || Number.isNaN(raw.dbh_m) ? null : height_m / raw.dbh_m > SLENDER,
  };
}

function reported(
  kept: readonly Raw[],
  skipped: readonly Skipped[],
  columns: Columns,
  units: Units,
  rows: number,
): Inventory {
  const stems = kept.map(stemOf);
  const width_m = spanOf(stems.map(({ east_m }) => east_m));
  const depth_m = spanOf(stems.map(({ north_m }) => north_m));
  const estimated = kept.filter(({ height_m }) => Number.isNaN(height_m)).length;
  const formless = stems.filter(({ slender }) => slender === null).length;
  const understood = Object.entries(columns.names).map(([what, name]) => {
    const unit = units[what === "y" ? "x" : what];
    return [what, unit ? `${name}: ${unit}` : name];
  });
  const heights = stems.map(({ height_m }) => height_m);
  const report: Report = {
    columns: Object.fromEntries(understood),
    rows,
    stems: stems.length,
    skipped: skipped.length,
    first_skipped: skipped.slice(0, MOST_LISTED),
    substitutes: substitutesOf(stems),
    width_m,
    depth_m,
    lowest_m: heights.reduce((least, height) => Math.min(least, height)),
    highest_m: heights.reduce((most, height) => Math.max(most, height)),
    per_ha: stems.length / (Math.max(width_m * depth_m, 100) / 10_000),
    estimated_heights: estimated,
    notes: notesOf(columns, units, { estimated, formless, stems: stems.length }),
  };
  return { stems, report };
}
