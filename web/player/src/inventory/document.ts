/** The inventory document: the stems of a stand, as `galewood convert` writes them (spec/formats/inventory.md). Pure. */

import { INVENTORY_VERSION } from "../core/constants";

/** A file that is no inventory document: what is wrong and what to do. */
export class InventoryError extends Error {
  override readonly name = "InventoryError";
}

/** A tree of the inventory, placed relative to the middle of the plot. */
export interface Stem {
  readonly east_m: number;
  readonly north_m: number;
  /** As in the file. */
  readonly species: string;
  /** The built-in species that stands for it. */
  readonly builtin: string;
  readonly height_m: number;
  /** Whether it has grown in a stand. */
  readonly slender: boolean;
  /** Diameter at 1.3 m, if it was measured. */
  readonly dbh_cm?: number;
}

/** How the file was interpreted: the main numbers as text by their names, and assumptions as sentences. */
export interface Report {
  readonly figures: Readonly<Record<string, string>>;
  readonly notes: readonly string[];
}

export interface Inventory {
  readonly stems: readonly Stem[];
  readonly report?: Report;
}

type Fields = Readonly<Record<string, unknown>>;

const isFields = (value: unknown): value is Fields =>
  typeof value === "object" && value !== null && !Array.isArray(value);

const NOT_CONVERTED =
  "This is not an inventory document; `galewood convert` makes one from a CSV or GeoJSON file";

/** Reads an inventory document, as text or parsed. Throws an InventoryError that names what is wrong. */
export function readInventory(given: unknown): Inventory {
  const document = typeof given === "string" ? parsed(given) : given;
  if (!isFields(document) || !Array.isArray(document.stems)) throw new InventoryError(NOT_CONVERTED);
  const { version, stems, report } = document;
  if (version !== INVENTORY_VERSION) {
    throw new InventoryError(
      `version: this reader knows version ${INVENTORY_VERSION}, not ${String(version)}`,
    );
  }
  if (stems.length === 0) throw new InventoryError("stems: expected at least one");
  const read = stems.map((stem, index) => stemAt(stem, `stems[${index}]`));
  return report === undefined ? { stems: read } : { stems: read, report: reportAt(report) };
}

function parsed(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    throw new InventoryError(NOT_CONVERTED);
  }
}

function stemAt(stem: unknown, path: string): Stem {
  if (!isFields(stem)) throw new InventoryError(`${path}: expected an object`);
  const number = (name: string) => {
    const value = stem[name];
    if (typeof value === "number" && Number.isFinite(value)) return value;
    throw new InventoryError(`${path}.${name}: expected a number`);
  };
  const text = (name: string) => {
    const value = stem[name];
    if (typeof value === "string") return value;
    throw new InventoryError(`${path}.${name}: expected a text`);
  };
  const size = (name: string) => {
    const value = number(name);
    if (value > 0) return value;
    throw new InventoryError(`${path}.${name}: expected a number above 0`);
  };
  const { slender } = stem;
  if (typeof slender !== "boolean") throw new InventoryError(`${path}.slender: expected true or false`);
  return {
    east_m: number("east_m"),
    north_m: number("north_m"),
    species: text("species"),
    builtin: text("builtin"),
    height_m: size("height_m"),
    slender,
    // null: it was not measured.
    ...((stem.dbh_cm ?? null) === null ? {} : { dbh_cm: size("dbh_cm") }),
  };
}

function reportAt(report: unknown): Report {
  const isText = (value: unknown) => typeof value === "string";
  if (isFields(report) && isFields(report.figures) && Array.isArray(report.notes)) {
    const { figures, notes } = report;
    if (Object.values(figures).every(isText) && notes.every(isText)) {
      return { figures: figures as Report["figures"], notes };
    }
  }
  throw new InventoryError(
    "report: expected the texts `figures` by their names, and a list of texts `notes`",
  );
}
