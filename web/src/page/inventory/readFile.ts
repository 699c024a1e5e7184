/** Reads the bytes of an inventory; a file of its own, because few visitors need it. */
import { type Inventory, readInventory, rowsOfGeojson } from "../../core/inventory/reading";
import { readRows, textOf } from "../files/rows";

/** Reads CSV or GeoJSON; throws InventoryError. */
export function readFile(bytes: Uint8Array): Inventory {
  const text = textOf(bytes);
  if (/^\s*\{/.test(text)) return readInventory(rowsOfGeojson(text), "feature");
  return readInventory(readRows(text));
}
