import { describe, expect, test } from "vitest";
import { glade, groundHeight_m } from "../../../../web/src/scene/ground/landscape";
import { atEdge, type Form, formAt, kindsOf, plant } from "../../../../web/src/scene/forms";
import { chooseSpecies, placeTrees, reach_m } from "../../../../web/src/scene/placement";

describe("placement", () => {
  test.each([1, 60, 400, 10_000])("gives exactly %i distinct places, none in the glade", (count) => {
    const places = placeTrees(count, 7);
    expect(places).toHaveLength(count);
    expect(new Set(places.map((place) => place.id)).size).toBe(count);
    expect(places.every((place) => glade(place.x_m, place.z_m) < 0.5)).toBe(true);
  });

  test("a larger forest keeps the places of the smaller one", () => {
    const few = placeTrees(100, 3);
    expect(placeTrees(1000, 3).slice(0, 100)).toEqual(few);
  });

  test("trees keep a minimum distance", () => {
    const places = placeTrees(300, 11);
    let nearest_m = Infinity;
    for (const a of places) {
      for (const b of places) {
        if (a !== b) nearest_m = Math.min(nearest_m, Math.hypot(a.x_m - b.x_m, a.z_m - b.z_m));
      }
    }
    expect(nearest_m).toBeGreaterThan(0.7);
  });

  test("a new species takes over some places and moves no other tree", () => {
    const places = placeTrees(400, 7);
    const before = chooseSpecies(places, ["poplar", "maple"]);
    const after = chooseSpecies(places, ["poplar", "maple", "mine"]);
    expect(after.filter((k) => k === 2).length).toBeGreaterThan(20);
    after.forEach((species, i) => {
      if (species !== 2) expect(species).toBe(before[i]);
    });
  });

  test("the ground is smooth: a step of 1 cm changes it by millimetres", () => {
    for (const place of placeTrees(200, 5)) {
      const slope = groundHeight_m(place.x_m + 0.01, place.z_m) - groundHeight_m(place.x_m, place.z_m);
      expect(Math.abs(slope)).toBeLessThan(0.01);
    }
  });
});

const grown = (id: string, form: Form, hasTable = true) => ({
  id,
  species: id.split("-")[0],
  builtin: true,
  form,
  hasTable,
});
const MAPLES = [grown("maple", "open"), grown("maple-forest", "forest")];

describe("forms", () => {
  test("a single tree and the trees of a small group have grown in the open", () => {
    for (const count of [1, 5]) expect(atEdge(placeTrees(count, 7))).not.toContain(false);
  });

  test.each([400, 2000])("of %i trees, those inside have neighbours all around, those at the edge do not", (count) => {
    const places = placeTrees(count, 7);
    const edge = atEdge(places);
    const rim_m = Math.max(...places.map(reach_m));
    const directions = Array.from({ length: 36 }, (_, k) => (k * Math.PI) / 18);
    for (const [i, { x_m, z_m }] of places.entries()) {
      // The exact nearest open ground is sought in finer steps than by the function under test.
      const around = (radius_m: number) =>
        directions.map((angle) => ({ x_m: x_m + radius_m * Math.cos(angle), z_m: z_m + radius_m * Math.sin(angle) }));
      const open = (place: { x_m: number; z_m: number }) =>
        reach_m(place) > rim_m || glade(place.x_m, place.z_m) >= 0.5;
      const nearby = (edge[i] ? [2, 4, 6, 8, 8.1] : [2, 4, 6, 7.3]).some((radius_m) => around(radius_m).some(open));
      expect(nearby).toBe(edge[i]);
    }
    const share = edge.filter(Boolean).length / count;
    expect(share).toBeGreaterThan(0.03);
    expect(share).toBeLessThan(0.5);
  });

  test("the forest-grown form is planted inside, the open-grown one at the edge", () => {
    const places = placeTrees(400, 7);
    const planted = plant(MAPLES, places, {});
    expect(planted.map((tree) => tree?.form === "open")).toEqual(atEdge(places));
    for (const form of ["open", "forest"] as const)
      expect(plant(MAPLES, places, {}, form).every((tree) => tree?.form === form)).toBe(true);
    expect(plant(MAPLES.slice(0, 1), places, {}).every((tree) => tree?.id === "maple")).toBe(true);
  });

  test("a second form changes the species of no place, and the share of a species is that of its forms", () => {
    const places = placeTrees(400, 7);
    const poplar = grown("poplar", "open");
    const species = (trees: typeof MAPLES, shares = {}) =>
      plant(trees, places, shares).map((tree) => tree?.species ?? null);
    expect(species([...MAPLES, poplar])).toEqual(species([MAPLES[0], poplar]));
    expect(new Set(species([...MAPLES, poplar], { maple: 0 }))).toEqual(new Set(["poplar"]));
    expect(new Set(species(MAPLES, { maple: 0 }))).toEqual(new Set([null]));
  });

  test("a form without a table is replaced by the other one", () => {
    const [kind] = kindsOf([grown("maple", "open"), grown("maple-forest", "forest", false)]);
    expect([true, false].map((edge) => formAt(kind, edge)?.id)).toEqual(["maple", "maple"]);
    const [other] = kindsOf([grown("maple", "open", false), grown("maple-forest", "forest")]);
    expect([true, false].map((edge) => formAt(other, edge)?.id)).toEqual(["maple-forest", "maple-forest"]);
    const [none] = kindsOf([grown("maple", "open", false), grown("maple-forest", "forest", false)]);
    expect([true, false].map((edge) => formAt(none, edge)?.id)).toEqual(["maple", "maple-forest"]);
    const [only] = kindsOf([grown("maple-forest", "forest")]);
    expect(only.id).toBe("maple");
    expect([true, false].map((edge) => formAt(only, edge)?.id)).toEqual(["maple-forest", "maple-forest"]);
  });

  test("uploads of a species are not its forms", () => {
    const mine = { ...grown("mine", "open"), species: "maple", builtin: false };
    expect(kindsOf([...MAPLES, mine]).map(({ id }) => id)).toEqual(["maple", "mine"]);
  });
});
