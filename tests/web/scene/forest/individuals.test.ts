/** Which trees are grown for the stems of an inventory, against choices by brute force. */
import { describe, expect, test } from "vitest";
import type { Stem } from "../../../../web/player/src/inventory/document";
import type { TreeModel } from "../../../../web/player/src/trees/mesh/treeMesh";
import type { TreeAsset } from "../../../../web/src/scene/forest";
import {
  arrivedOf,
  distance,
  formOf,
  type Individual,
  nearestIndividual,
  sizeOfStem,
  spread,
  treesToGrow,
} from "../../../../web/src/scene/individuals";
import { placeStand } from "../../../../web/src/scene/stand";
import { seededRandom } from "../../seeded";

const SPECIES = ["oak", "beech", "spruce"] as const;

function stand(random: () => number, count: number): Stem[] {
  return Array.from({ length: count }, (_, k) => ({
    east_m: 5 * k,
    north_m: 0,
    species: "",
    builtin: SPECIES[Math.floor(random() ** 2 * SPECIES.length)],
    height_m: 8 + 20 * random(),
    slender: random() < 0.5,
    ...(random() < 0.7 ? { dbh_cm: 12 + 40 * random() } : {}),
  }));
}

/** The least that the largest number of stems per tree can be, over all ways to spread a budget. */
function leastCrowding(sizes: readonly number[], budget: number): number {
  if (sizes.length === 0) return 0;
  const [first, ...rest] = sizes;
  let least = Number.POSITIVE_INFINITY;
  for (let trees = 1; trees <= Math.min(first, budget); trees++) {
    least = Math.min(least, Math.max(first / trees, leastCrowding(rest, budget - trees)));
  }
  return least;
}

describe("the budget", () => {
  test("is spread so that no tree stands for more stems than it must", () => {
    const random = seededRandom(41);
    for (let round = 0; round < 60; round++) {
      const sizes = Array.from({ length: 1 + Math.floor(4 * random()) }, () => 1 + Math.floor(9 * random()));
      const budget = sizes.length + Math.floor(8 * random());
      const counts = spread(sizes, budget);
      const total = counts.reduce((sum, count) => sum + count, 0);
      expect(total).toBe(Math.min(budget, sizes.reduce((sum, size) => sum + size, 0)));
      expect(Math.max(...sizes.map((size, k) => size / counts[k]))).toBeCloseTo(leastCrowding(sizes, budget), 12);
    }
  });

  test("goes to the largest groups if it does not reach all", () => {
    expect(spread([5, 9, 2, 7], 2)).toEqual([0, 1, 0, 1]);
    expect(spread([3], 0)).toEqual([0]);
  });
});

describe("the trees to grow", () => {
  test("are of the species, forms and sizes of the stems, and the same every time", () => {
    const random = seededRandom(42);
    const stems = stand(random, 200);
    const orders = treesToGrow(stems, 24, "place");
    expect(orders).toEqual(treesToGrow([...stems], 24, "place"));
    expect(orders).toHaveLength(24);
    expect(new Set(orders.map((order) => JSON.stringify(order))).size).toBe(24);
    for (const order of orders) {
      const alike = stems.filter((one) => one.builtin === order.species && formOf(one, "place") === order.form);
      expect(Math.min(...alike.map(({ height_m }) => Math.abs(height_m - order.height_m)))).toBeLessThan(0.051);
    }
  });

  test("are one for every stem if the budget allows, and half of each kind's sizes lie on either side otherwise", () => {
    const stems = stand(seededRandom(43), 30);
    expect(treesToGrow(stems, 400, "place")).toHaveLength(30);
    const oaks = stems.map((one, k) => ({ ...one, builtin: "oak", slender: false, height_m: 10 + k }));
    expect(treesToGrow(oaks, 1, "place")[0].height_m).toBe(25);
    expect(treesToGrow(oaks, 3, "forest").map(({ form, height_m }) => [form, height_m])).toEqual([
      ["forest", 15], ["forest", 25], ["forest", 35],
    ]);
  });
});

const individuals = (stems: readonly Stem[], budget: number): Individual[] =>
  treesToGrow(stems, budget, "place").map(({ seed: _, ...size }, k) => ({ ...size, id: `own-${k}` }));

const asset = (tree: Individual, more: Partial<TreeAsset> = {}): TreeAsset => ({
  id: tree.id,
  species: tree.species,
  builtin: false,
  form: tree.form,
  hasTable: true,
  model: { height_m: tree.height_m, radius_m: 3 } as TreeModel,
  motion: {} as TreeAsset["motion"],
  ...more,
});

describe("a stem", () => {
  test("is shown by the nearest tree of its species and form", () => {
    const stems = stand(seededRandom(44), 300);
    const grown = individuals(stems, 30);
    const nearest = nearestIndividual(grown);
    for (const stem of stems) {
      const alike = grown.filter(
        (tree) => tree.species === stem.builtin && tree.form === (stem.slender ? "forest" : "open"),
      );
      const size = sizeOfStem(stem, "place");
      const found = nearest(size);
      expect(found).not.toBeNull();
      for (const tree of alike) expect(distance(size, found!)).toBeLessThanOrEqual(distance(size, tree));
    }
    expect(nearest({ ...sizeOfStem(stems[0], "place"), species: "willow" })).toBeNull();
  });

  test("has its height, and keeps its built-in tree until all others have arrived", () => {
    const stems = stand(seededRandom(45), 40).map((stem) => ({ ...stem, builtin: "oak", slender: false }));
    const grown = individuals(stems, 4);
    const builtin = { ...asset({ ...grown[0], id: "oak" }), builtin: true };
    const places = (more: Partial<TreeAsset>) => {
      const assets = [builtin, ...grown.slice(1).map((tree) => asset(tree)), asset(grown[0], more)];
      return placeStand(assets, stems, { form: "place", named: () => null, individuals: grown });
    };
    const ids = (found: Map<TreeAsset, unknown>) => [...found.keys()].map(({ id }) => id).sort();
    expect(ids(places({ motion: null }))).toEqual(["oak"]);
    expect(ids(places({ motion: null, hasTable: false }))).toEqual(["own-1", "own-2", "own-3"]);
    const all = places({});
    expect(ids(all)).toEqual(["own-0", "own-1", "own-2", "own-3"]);
    for (const [{ model }, own] of all) {
      for (const { id, scale } of own) {
        expect(scale * model!.height_m).toBeCloseTo(stems[id % 2 ** 25].height_m, 6);
      }
    }
    expect(arrivedOf(grown, [])).toEqual([]);
  });
});
