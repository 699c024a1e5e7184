/** What a data file holds: documents are read here, tables of measurements by the service. */
import { type Inventory, InventoryError, readInventory } from "galewood/inventory";
import { parseWind, type WindDocument, WindError } from "galewood/wind";
import { Problem } from "../server/api";
import { convertFile, type MeasuredWind } from "../server/conversion";

export type Content =
  | { readonly kind: "inventory"; readonly inventory: Inventory }
  | { readonly kind: "wind"; readonly wind: WindDocument }
  | { readonly kind: "measurement"; readonly found: MeasuredWind };

/** The content of a file; null if it may be a tree. Throws a Problem that says what is wrong. */
export async function contentOf(file: File): Promise<Content | null> {
  const document = await documentIn(file);
  if ("stems" in document) return { kind: "inventory", inventory: inventoryFrom(document) };
  if ("model" in document) return { kind: "wind", wind: windFrom(document) };
  const found = await convertFile(file);
  if (found === null) return null;
  return "stems" in found
    ? { kind: "inventory", inventory: inventoryFrom(found) }
    : { kind: "measurement", found };
}

/** The JSON object in a file; an empty one if it holds something else. Throws a Problem. */
async function documentIn(file: File): Promise<object> {
  const beginning = await file.slice(0, 100).text();
  if (!/^\s*\{/.test(beginning)) return {};
  try {
    return JSON.parse(await file.text());
  } catch {
    throw new Problem("The file is not valid JSON.", "It begins like JSON, but is damaged or incomplete.");
  }
}

/** Reads an inventory document, as text or parsed. Throws a Problem. */
export function inventoryFrom(document: unknown): Inventory {
  try {
    return readInventory(document);
  } catch (error) {
    if (!(error instanceof InventoryError)) throw error;
    throw new Problem("The inventory could not be read.", `${error.message}.`);
  }
}

function windFrom(document: unknown): WindDocument {
  try {
    return parseWind(document);
  } catch (error) {
    if (!(error instanceof WindError)) throw error;
    throw new Problem("The wind file is invalid.", error.message);
  }
}
