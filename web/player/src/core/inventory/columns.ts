/** Which column of an inventory holds what, and in which unit. Twin: precompute/galewood/inventory/columns.py. */
import type { Row } from "../files/delimited";
import { InventoryError } from "./errors";
import { writtenOut } from "./species";

export type Content = "x" | "y" | "lon" | "lat" | "genus" | "species" | "height" | "dbh" | "girth";

const NAMES: Readonly<Record<Content, string>> = {
  x: "x|x (m|coord[a-z]*)|coord[a-z]* x|pos x|x pos|east|easting|utm x|utm e(ast)?|rechtswert|ostwert",
  y: "y|y (m|coord[a-z]*)|coord[a-z]* y|pos y|y pos|north|northing|utm y|utm n(orth)?|hochwert|nordwert",
  lon: "lon|long|lng|longitude|laenge|laengengrad|(decimal|wgs84) lon(gitude)?",
  lat: "lat|latitude|breite|breitengrad|(decimal|wgs84) lat(itude)?",
  genus: "genus|gattung",
  species:
    "species|(tree )?species( name| latin| code)?|scientific ?name|latin ?name|botanical ?name|common ?name|baumart|art|artname|art (deutsch|latein|botanisch)|botanischer name|taxon|spp|sp|tree",
  height: "height|tree height|total height|h|ht|hoehe|baumhoehe",
  dbh: "dbh|bhd|diameter|d130|d13|d1 3|d|trunk diameter|stem diameter|stammdurchmesser|durchmesser",
  girth: "gbh|cbh|girth|circumference|trunk circumference|umfang|stammumfang",
};
const UNIT_WORD = "(?: (?:mm|cm|dm|m|ft|feet|in|inch|inches|meters?|metres?|deg))?";
const PATTERNS = Object.entries(NAMES).map(
  ([what, names]) => [what as Content, new RegExp(`^(?:(?:${names})${UNIT_WORD})$`)] as const,
);
export const LENGTHS_M: Readonly<Record<string, number>> = {
  mm: 0.001,
  cm: 0.01,
  dm: 0.1,
  m: 1,
  ft: 0.3048,
  in: 0.0254,
};
const SYNONYMS: Readonly<Record<string, string>> = {
  feet: "ft",
  inch: "in",
  inches: "in",
  meter: "m",
  meters: "m",
  metre: "m",
  metres: "m",
};
const HEADER_WITHIN = 50;
const NEEDED =
  "no column names were found. Needed are 'x' and 'y' (m) or 'lon' and 'lat', and 'height' (m) or 'dbh' (cm); 'species' is useful";

/** Index of each column by what it holds, its name, and its unit as far as it is stated. */
export interface Columns {
  readonly index: Partial<Record<Content, number>>;
  readonly names: Partial<Record<Content, string>>;
  readonly units: Partial<Record<Content, string>>;
}

/** The cell of a row; empty without such a column. */
export const cellOf = ({ index }: Columns, row: Row, what: Content): string =>
  row.cells[index[what] ?? -1] ?? "";

/** Whether places are longitudes and latitudes. */
export const isGeographic = ({ index }: Columns): boolean => index.x === undefined || index.y === undefined;

/** The columns and the index of the row after their names; throws InventoryError. */
export function findHeader(rows: readonly Row[]): { columns: Columns; first: number } {
  for (const [k, row] of rows.slice(0, HEADER_WITHIN).entries()) {
    const columns = columnsOf(row);
    if (columns) return { columns, first: k + 1 };
  }
  throw new InventoryError(NEEDED);
}

/** The columns that a row of names describes; null if it is no such row. */
export function columnsOf({ cells }: Row): Columns | null {
  const plain = cells.map(plainName);
  const found = PATTERNS.flatMap(([what, pattern]) => {
    const k = plain.findIndex((name) => pattern.test(name));
    return k < 0 ? [] : [[what, k] as const];
  });
  const index: Columns["index"] = Object.fromEntries(found);
  const has = (...wanted: Content[]) => wanted.every((what) => index[what] !== undefined);
  if (!(has("x", "y") || has("lon", "lat")) || !(has("height") || has("dbh") || has("girth"))) return null;
  return {
    index,
    names: Object.fromEntries(found.map(([what, k]) => [what, cells[k]])),
    units: Object.fromEntries(found.map(([what, k]) => [what, unitOf(cells[k])])),
  };
}

/** A name in lower case, without brackets, umlauts written out, words separated by single blanks. */
function plainName(cell: string): string {
  const text = writtenOut(
    cell
      .toLowerCase()
      .replace(/^#+/, "")
      .replace(/[[(].*?[\])]/g, " "),
  );
  return text.replace(/[^a-z0-9]+/g, " ").trim();
}

/** The unit in the brackets of a name, or its last word; empty if it states none. */
function unitOf(name: string): string {
  const bracket = /[[(](.*?)[\])]/.exec(name);
  const words = plainName(name).split(" ");
  const word = bracket ? bracket[1].trim().toLowerCase() : words.length > 1 ? words[words.length - 1] : "";
  const unit = SYNONYMS[word] ?? word;
  return unit in LENGTHS_M ? unit : "";
}
