/** Stems of an inventory as trees of the package galewood. */
import { Matrix4, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { InventoryError, placesOf, plantInventory, readInventory } from "../../../web/player/src/inventory";
import type { TreeFiles } from "../../../web/player/src/three";

const stem = (east_m: number, north_m: number, species: string, builtin: string, height_m: number) => ({
  line: 2,
  east_m,
  north_m,
  species,
  builtin,
  height_m,
  slender: false,
});
const STAND = {
  version: 1,
  stems: [
    stem(-5, -10, "Quercus robur", "maple", 20),
    stem(5, -10, "Populus nigra", "poplar", 30),
    stem(-5, 10, "Larix decidua", "poplar", 1),
    stem(5, 10, "Acer campestre", "maple", 80),
  ],
  report: { rows: 4, figures: { Trees: "4 of 4 rows" }, notes: ["No unit of the heights was found: m is assumed."] },
};

describe("the inventory document", () => {
  test("is read as text and parsed", () => {
    const read = readInventory(JSON.stringify(STAND));
    expect(read).toEqual(readInventory(STAND));
    expect(read.stems.map(({ east_m, north_m, height_m }) => [east_m, north_m, height_m])).toEqual(
      STAND.stems.map(({ east_m, north_m, height_m }) => [east_m, north_m, height_m]),
    );
    expect(read.report).toEqual({ figures: STAND.report.figures, notes: STAND.report.notes });
    expect(readInventory({ version: 1, stems: STAND.stems }).report).toBeUndefined();
  });

  test.each<[string, unknown, string]>([
    ["a table", "x;y;height\n0;0;9\n", "`galewood convert` makes one from a CSV or GeoJSON file"],
    ["GeoJSON", { type: "FeatureCollection", features: [] }, "`galewood convert`"],
    ["nothing", null, "`galewood convert`"],
    ["another version", { ...STAND, version: 2 }, "version: this reader knows version 1, not 2"],
    ["no stems", { ...STAND, stems: [] }, "stems: expected at least one"],
    ["no stem", { ...STAND, stems: [STAND.stems[0], 3] }, "stems[1]: expected an object"],
    ["a text as a place", { ...STAND, stems: [{ ...STAND.stems[0], east_m: "3" }] }, "stems[0].east_m: expected a number"],
    ["no height", { ...STAND, stems: [{ ...STAND.stems[0], height_m: 0 }] }, "stems[0].height_m: expected a number above 0"],
    ["no species", { ...STAND, stems: [{ ...STAND.stems[0], species: null }] }, "stems[0].species: expected a text"],
    ["a diameter of 0", { ...STAND, stems: [{ ...STAND.stems[0], dbh_cm: 0 }] }, "stems[0].dbh_cm: expected a number above 0"],
    ["a diameter in words", { ...STAND, stems: [{ ...STAND.stems[0], dbh_cm: "20" }] }, "stems[0].dbh_cm: expected a number"],
    ["no form", { ...STAND, stems: [{ ...STAND.stems[0], slender: null }] }, "stems[0].slender: expected true or false"],
    ["no texts", { ...STAND, report: { figures: { Trees: 4 }, notes: [] } }, "report: expected the texts"],
  ])("with %s is refused", (_, document, message) => {
    expect(() => readInventory(document)).toThrow(InventoryError);
    expect(() => readInventory(document)).toThrow(message);
  });
});

describe("places of an inventory", () => {
  test("are those of the stems: x to the east, z to the south, about the middle; as tall as measured, within limits", () => {
    const places = placesOf(readInventory(STAND), { maple: 10, poplar: 15 });
    expect(places.maple.map(({ x_m, z_m, scale }) => [x_m, z_m, scale])).toEqual([
      [-5, 10, 2],
      [5, -10, 4],
    ]);
    expect(places.poplar.map(({ x_m, z_m, scale }) => [x_m, z_m, scale])).toEqual([
      [5, 10, 2],
      [-5, -10, 0.15],
    ]);
  });

  test("a tree of the stem's own species comes first; the first kind stands for all that is missing", () => {
    const places = placesOf(readInventory(STAND), { apricot: 5, "Larix decidua": 25 });
    expect(places["Larix decidua"]).toHaveLength(1);
    expect(places.apricot).toHaveLength(3);
    expect(() => placesOf(readInventory(STAND), {})).toThrow(RangeError);
  });
});

test("an inventory is planted in one call, on its ground, and kinds without stems are not", async () => {
  const heights_m: Record<string, number> = { maple: 10, poplar: 15 };
  const placed = new Map<unknown, readonly Matrix4[]>();
  const forest = {
    plant: async (files: TreeFiles, places: readonly Matrix4[]) => {
      const planted = { height_m: heights_m[String(files.mesh)], count: places.length };
      placed.set(planted, places);
      return planted as never;
    },
    move: (planted: unknown, places: readonly Matrix4[]) => void placed.set(planted, places),
  };
  const tree = (name: string) => ({ table: name, mesh: name });
  const trees = { maple: tree("maple"), poplar: tree("poplar"), apricot: tree("apricot") };
  const planted = await plantInventory(forest, readInventory(STAND), trees, (x_m) => 0.1 * x_m);
  expect(Object.keys(planted)).toEqual(["maple", "poplar"]);
  const [, tall] = placed.get(planted.maple) ?? [];
  expect(new Vector3().setFromMatrixPosition(tall).toArray()).toEqual([5, 0.5, -10]);
  expect(new Vector3().setFromMatrixScale(tall).y).toBeCloseTo(4, 12);
});
