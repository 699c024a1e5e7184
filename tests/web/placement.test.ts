import { describe, expect, test } from "vitest";
import { glade, groundHeight_m } from "../../web/src/scene/ground/landscape";
import { chooseSpecies, placeTrees } from "../../web/src/scene/placement";

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
