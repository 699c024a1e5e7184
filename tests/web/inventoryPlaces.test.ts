/** Stems of an inventory as trees of the package galewood. */
import { Matrix4, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { placesOf, plantInventory, readInventory } from "../../web/player/src/inventory";
import type { TreeFiles } from "../../web/player/src/three";

const STAND = `x;y;species;height
0;0;Quercus robur;20
10;0;Populus nigra;30
0;20;Larix decidua;1
10;20;Acer campestre;80
`;
const GEOJSON = JSON.stringify({
  type: "FeatureCollection",
  features: [{ type: "Feature", geometry: { type: "Point", coordinates: [8, 47] }, properties: { species: "oak", height: 12 } }],
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

  test("GeoJSON and bytes are read as well", () => {
    const [stem] = readInventory(new TextEncoder().encode(GEOJSON)).stems;
    expect([stem.species, stem.builtin, stem.height_m]).toEqual(["oak", "maple", 12]);
    expect(() => readInventory("no;table\n1;2\n")).toThrow("x");
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
