import { describe, expect, test } from "vitest";
import type { Stem } from "../../../../web/player/src/inventory/document";
import { SCALES } from "../../../../web/player/src/inventory/places";
import { extentOf, placeStand, standView } from "../../../../web/src/scene/stand";
import type { TreeAsset } from "../../../../web/src/scene/forest";
import { FOREST_CENTRE } from "../../../../web/src/scene/placement";
import type { TreeModel } from "../../../../web/player/src/trees/mesh/treeMesh";

const asset = (id: string, species: string, form: "open" | "forest", height_m: number, builtin = true): TreeAsset => ({
  id,
  species,
  builtin,
  form,
  hasTable: true,
  model: { height_m, radius_m: 3 } as TreeModel,
  motion: null,
});

const ASSETS = [
  asset("m", "maple", "open", 12),
  asset("mf", "maple", "forest", 20),
  asset("p", "poplar", "open", 16),
  asset("own", "oak", "open", 10, false),
];
const stem = (given: Partial<Stem>): Stem => ({
  east_m: 0,
  north_m: 0,
  species: "",
  builtin: "maple",
  height_m: 12,
  slender: false,
  ...given,
});
const OPTIONS = { form: "place", named: () => null } as const;
const place = (stems: Stem[], options: object = {}) =>
  Object.fromEntries(
    [...placeStand(ASSETS, stems, { ...OPTIONS, ...options })].map(([{ id }, places]) => [id, places]),
  );

describe("stems of an inventory", () => {
  test("stand at their places, north away from the viewer, as tall as measured", () => {
    const { m } = place([stem({ east_m: 7, north_m: 3, height_m: 15 })]);
    expect(m).toHaveLength(1);
    expect(m[0].x_m).toBeCloseTo(FOREST_CENTRE.x_m + 7, 5);
    expect(m[0].z_m).toBeCloseTo(FOREST_CENTRE.z_m - 3, 5);
    expect(12 * m[0].scale).toBeCloseTo(15, 5);
  });

  test("have their own form, or the one that was chosen", () => {
    const two = [stem({ slender: true, height_m: 20 }), stem({ slender: false })];
    expect(Object.keys(place(two)).sort()).toEqual(["m", "mf"]);
    expect(place(two, { form: "forest" }).mf).toHaveLength(2);
    expect(place(two, { form: "open" }).m).toHaveLength(2);
  });

  test("are shown by an upload of their name, and by another species if the server lacks theirs", () => {
    const found = place([stem({ species: "Oak" }), stem({ builtin: "apricot" })], {
      named: (name: string) => (name === "Oak" ? "own" : null),
    });
    expect(found.own).toHaveLength(1);
    expect(found.m).toHaveLength(1);
  });

  test("keep within the limits of size", () => {
    const { p } = place([0.5, 100].map((height_m) => stem({ builtin: "poplar", height_m })));
    expect(p[0].scale).toBeCloseTo(SCALES.least, 6);
    expect(p[1].scale).toBeCloseTo(SCALES.most, 6);
  });
});

test("the extent of a stand is that of its stems, and its highest tree", () => {
  const stems = [stem({ east_m: -30, north_m: 2 }), stem({ east_m: 30, north_m: -4, height_m: 20 }), stem({ north_m: 4 })];
  expect(extentOf(stems)).toEqual({ width_m: 60, depth_m: 8, highest_m: 20 });
});

test("the camera has the whole plot in its width", () => {
  for (const aspect of [0.46, 1, 1.78]) {
    const { eye, target } = standView({ width_m: 60, depth_m: 50, highest_m: 20 }, aspect);
    const reach = Math.tan((23 * Math.PI) / 180) * aspect * (eye.z - (FOREST_CENTRE.z_m + 25));
    expect(FOREST_CENTRE.x_m + 0.85 * 30).toBeLessThan(target.x + reach);
    expect(FOREST_CENTRE.x_m - 0.85 * 30).toBeGreaterThan(target.x - reach);
    expect(eye.z).toBeGreaterThan(FOREST_CENTRE.z_m + 25);
    // in a narrow picture, below the cards: the tops of the trees are below its middle
    const sinks = (target.above - eye.above) / (eye.z - target.z);
    const tops = (20 - eye.above) / (eye.z - target.z);
    expect(tops < sinks).toBe(aspect < 1.2);
  }
});
