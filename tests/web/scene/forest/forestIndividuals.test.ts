/** The own trees of a generated forest: how many of each kind, of which sizes and seeds, and where they stand. */
import { describe, expect, test } from "vitest";
import { builtinOf, growIndividual } from "../../../../tools/species/individual";
import type { TreeModel } from "../../../../web/player/src/trees/mesh/treeMesh";
import { placeForest, type TreeAsset } from "../../../../web/src/scene/forest";
import {
  type BuiltinTree,
  type ForestLayout,
  individualsInstead,
  sizesOfForest,
  treesOfForest,
} from "../../../../web/src/scene/forestIndividuals";
import { FORM_CHOICES, type Form } from "../../../../web/src/scene/forms";
import type { Individual, Order, Size } from "../../../../web/src/scene/individuals";
import { DEFAULTS } from "../../../../web/src/page/settings/settings";
import { seededRandom } from "../../seeded";

const FORMS = ["open", "forest"] as const;
const SPECIES = ["beech", "birch", "maple", "oak", "spruce"];
const idOf = (species: string, form: Form) => (form === "open" ? species : `${species}-forest`);
const BUILTIN: BuiltinTree[] = SPECIES.flatMap((species) =>
  FORMS.map((form) => ({
    id: idOf(species, form),
    species,
    builtin: true,
    form,
    height_m: builtinOf({ species, form }).height_m,
  })),
);
const { trees, forestSeed, density, form } = DEFAULTS;
const USUAL: ForestLayout = { trees, forestSeed, density, form, shares: {} };

const kindOf = ({ species, form: grown }: Size) => idOf(species, grown);
function counted(sizes: readonly Size[]): Map<string, number> {
  const counts = new Map<string, number>();
  for (const size of sizes) counts.set(kindOf(size), (counts.get(kindOf(size)) ?? 0) + 1);
  return counts;
}

describe("the trees to grow", () => {
  test("follow from the settings, in whatever order the server tells of its trees", () => {
    const orders = treesOfForest(BUILTIN, USUAL, 24);
    expect(orders).toHaveLength(24);
    expect(new Set(orders.map((order) => JSON.stringify(order))).size).toBe(24);
    expect(treesOfForest([...BUILTIN].reverse(), USUAL, 24)).toEqual(orders);
    expect(treesOfForest(BUILTIN, { ...USUAL, forestSeed: 8 }, 24)).not.toEqual(orders);
    expect(treesOfForest(BUILTIN, USUAL, 0)).toEqual([]);
    expect(treesOfForest([], USUAL, 24)).toEqual([]);
    for (const { seed, dbh_cm } of orders) {
      expect(Math.floor(seed / 1000)).toBe(forestSeed);
      expect(dbh_cm).toBeNull();
    }
  });

  test("are divided by the shares of the kinds: no other division has fewer trees of the forest per tree", () => {
    const random = seededRandom(61);
    for (let round = 0; round < 12; round++) {
      const layout: ForestLayout = {
        ...USUAL,
        trees: 40 + Math.floor(400 * random()),
        forestSeed: Math.floor(10_000 * random()),
        form: FORM_CHOICES[round % 3],
        shares: Object.fromEntries(SPECIES.map((species) => [species, random() < 0.3 ? 0 : random()])),
      };
      const all = counted(sizesOfForest(BUILTIN, layout));
      const budget = all.size + Math.floor(20 * random());
      const own = counted(treesOfForest(BUILTIN, layout, budget));
      for (const species of SPECIES) {
        if (layout.shares[species] === 0) expect([...own.keys()].filter((id) => id.startsWith(species))).toEqual([]);
      }
      const perTree = (kind: string, count: number) => (all.get(kind) ?? 0) / count;
      const most = Math.max(...[...all.keys()].map((kind) => perTree(kind, own.get(kind) ?? 0)));
      // the kind with most trees per own tree could be relieved only by a tree of another one, which would then have as many
      for (const [kind, count] of own) expect(perTree(kind, count - 1)).toBeGreaterThanOrEqual(most);
    }
  });

  test("of a larger budget are those of the smaller one and others", () => {
    for (let budget = 1; budget <= 40; budget++) {
      const more = treesOfForest(BUILTIN, USUAL, budget).map((order) => JSON.stringify(order));
      const fewer = treesOfForest(BUILTIN, USUAL, budget - 1).map((order) => JSON.stringify(order));
      expect(more).toHaveLength(budget);
      expect(more).toEqual(expect.arrayContaining(fewer));
    }
  });

  test("have heights of the placement's own distribution", () => {
    const layout: ForestLayout = { ...USUAL, trees: 4000, form: "open", shares: { oak: 0, beech: 0, birch: 0, maple: 0 } };
    const heights_m = sizesOfForest(BUILTIN, layout).map((size) => size.height_m).sort((a, b) => a - b);
    for (const budget of [1, 7, 15, 31]) {
      const own_m = treesOfForest(BUILTIN, layout, budget).map((order) => order.height_m).sort((a, b) => a - b);
      own_m.forEach((height_m, k) => {
        // the share of the placed trees that are lower: those of an exact placement lie in the middle of equal parts
        const lower = heights_m.filter((one) => one < height_m).length / heights_m.length;
        expect(Math.abs(lower - (k + 1) / (budget + 1))).toBeLessThan(0.03);
      });
    }
  });

  test("have sizes that their species can have: the generator takes them as they are", () => {
    for (const layout of [USUAL, { ...USUAL, form: "open" }, { ...USUAL, form: "forest" }] as const) {
      for (const order of treesOfForest(BUILTIN, layout, 40)) {
        const { height_m } = builtinOf(order);
        expect(order.height_m).toBeGreaterThan(0.7 * height_m);
        expect(order.height_m).toBeLessThan(1.3 * height_m);
      }
    }
    const birches = { oak: 0, beech: 0, maple: 0, spruce: 0 };
    const orders = treesOfForest(BUILTIN, { ...USUAL, shares: birches }, 15).sort((a, b) => a.height_m - b.height_m);
    for (const order of [orders[0], orders[14]]) {
      expect(growIndividual(order).nodes.length).toBeGreaterThan(0); // throws a RangeError otherwise
    }
  });
});

const individualOf = ({ seed, ...size }: Order): Individual => ({ ...size, id: `${kindOf(size)}-${seed}` });
const assetOf = (tree: Omit<Individual, "dbh_cm">, more: Partial<TreeAsset> = {}): TreeAsset => ({
  id: tree.id,
  species: tree.species,
  builtin: false,
  form: tree.form,
  hasTable: true,
  model: { height_m: tree.height_m, radius_m: 3, leans: false } as unknown as TreeModel,
  motion: {} as TreeAsset["motion"],
  ...more,
});

describe("the forest", () => {
  const individuals = treesOfForest(BUILTIN, USUAL, 30).map(individualOf);
  const builtin = BUILTIN.map((tree) => assetOf(tree, { builtin: true }));
  const own = individuals.map((tree) => assetOf(tree));
  const planted = (assets: readonly TreeAsset[]) =>
    placeForest(assets, USUAL.trees, USUAL.forestSeed, {
      ...USUAL,
      grows: (asset) => asset.builtin,
      instead: individualsInstead(individuals, assets),
    });
  /** By the id of the place: its tree, and the height. */
  const byPlace = (assets: readonly TreeAsset[]) =>
    new Map(
      planted(assets).flatMap(({ asset, instances }) =>
        Array.from(instances.ids, (id, k) => [
          id,
          { asset, height_m: instances.data[k * (instances.data.length / instances.count) + 6] * asset.model!.height_m },
        ]),
      ),
    );

  test("has at every place the nearest own tree of its species and form, as high as the built-in one", () => {
    const before = byPlace(builtin);
    const after = byPlace([...builtin, ...own]);
    expect(before.size).toBe(USUAL.trees);
    expect([...after.keys()].sort()).toEqual([...before.keys()].sort());
    for (const [id, { asset, height_m }] of after) {
      const was = before.get(id)!;
      expect(height_m).toBeCloseTo(was.height_m, 4);
      expect([asset.species, asset.form, asset.builtin]).toEqual([was.asset.species, was.asset.form, false]);
      const alike = individuals.filter((tree) => tree.species === asset.species && tree.form === asset.form);
      const away = (tree: { height_m: number }) => Math.abs(Math.log(tree.height_m / height_m));
      for (const tree of alike) expect(away(asset.model!)).toBeLessThanOrEqual(away(tree) + 1e-6);
    }
    expect(new Set([...after.values()].map(({ asset }) => asset.id)).size).toBe(30);
  });

  test("keeps its built-in trees until the last own one is loaded, and for kinds without any", () => {
    const waiting = [...builtin, ...own.slice(1), { ...own[0], motion: null }];
    expect([...byPlace(waiting).values()].every(({ asset }) => asset.builtin)).toBe(true);
    const lost = [...builtin, ...own.filter(({ species }) => species !== "oak")];
    for (const { asset } of byPlace(lost).values()) expect(asset.builtin).toBe(asset.species === "oak");
  });
});
