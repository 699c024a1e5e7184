/** Forests from inventories: CSV or GeoJSON with a place, a species and a height or diameter of every stem. */
import { columnsOf } from "./core/inventory/columns";
import { type Inventory, readInventory as readStems, rowsOfGeojson } from "./core/inventory/reading";
import { readRows, type TextFile, textOf } from "./files/rows";

export { type Inventory, InventoryError, type Report, type Stem } from "./core/inventory/reading";
export { type TextFile, textOf } from "./files/rows";
export { placesOf, SCALES } from "./inventory/places";
export { plantInventory } from "./inventory/plant";

const LOOKED_AT = 100;

const isJson = (text: string): boolean => /^\s*\{/.test(text);

/** Whether a table, or its beginning, has the columns of an inventory. */
export const isInventory = (file: TextFile): boolean =>
  readRows(file)
    .slice(0, LOOKED_AT)
    .some((row) => columnsOf(row) !== null);

/**
 * Reads an inventory. Stems are in metres east and north of the middle of the plot. Throws an InventoryError that says
 * what is wrong if no row describes a tree.
 */
export function readInventory(file: TextFile): Inventory {
  const text = textOf(file);
  return isJson(text) ? readStems(rowsOfGeojson(text), "feature") : readStems(readRows(text));
}
