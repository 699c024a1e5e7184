import { describe, expect, test } from "vitest";
import { type Inventory, InventoryError, readInventory, rowsOfGeojson } from "../../web/player/src/core/inventory/reading";
import { matchSpecies } from "../../web/player/src/core/inventory/species";
import { readRows } from "../../web/player/src/files/rows";
import { goldenJson } from "./golden";

interface Golden {
  files: ({ name: string; text: string } & Inventory)[];
  refused: { name: string; text: string; error: string }[];
  species: Record<string, { builtin: string; genus: string }>;
}

const golden = goldenJson<Golden>("inventory.json");
const read = (text: string): Inventory =>
  text.startsWith("{") ? readInventory(rowsOfGeojson(text), "feature") : readInventory(readRows(text));

/** Numbers to 1e-6, all else exactly. */
function same(own: unknown, expected: unknown, path: string): void {
  if (typeof expected === "number") expect(own, path).toBeCloseTo(expected, 6);
  else if (typeof expected === "object" && expected !== null) {
    expect(Object.keys(own as object), path).toEqual(Object.keys(expected));
    for (const [key, value] of Object.entries(expected)) same((own as Record<string, unknown>)[key], value, `${path}.${key}`);
  } else expect(own, path).toBe(expected);
}

describe("reads the same trees as Python", () => {
  test.each(golden.files)("$name", ({ text, stems, report }) => {
    const found = read(text);
    same(found.stems, stems, "stems");
    same(found.report, report, "report");
  });

  test.each(golden.refused)("refuses $name", ({ text, error }) => {
    expect(() => read(text)).toThrow(new InventoryError(error));
  });

  test("names of species", () => {
    for (const [name, { builtin, genus }] of Object.entries(golden.species)) {
      expect(matchSpecies(name, 10), name).toMatchObject({ builtin, genus });
    }
  });
});
