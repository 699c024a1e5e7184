import { fileURLToPath } from "node:url";
import { runInNewContext } from "node:vm";
import { rolldown } from "rolldown";
import { describe, expect, it } from "vitest";
import { withoutPictures } from "../../tools/species/bundle-sources";
import type { SurfaceMesh } from "../../tools/species/growth/surface";
import { growIndividual, type Individual } from "../../tools/species/individual";

const BREAST_HEIGHT_M = 1.3;

/** The first closed tube of the wood: without the boughs, which may cross breast height as well. */
function stemOf(wood: SurfaceMesh): SurfaceMesh {
  const inside = new Set([wood.indices[0]]);
  for (let size = 0; size < inside.size; ) {
    size = inside.size;
    for (let t = 0; t < wood.indices.length; t += 3) {
      const corners = wood.indices.slice(t, t + 3);
      if (corners.some((v) => inside.has(v))) for (const v of corners) inside.add(v);
    }
  }
  const indices = Array.from({ length: wood.indices.length / 3 }, (_, t) => wood.indices.slice(3 * t, 3 * t + 3));
  return { ...wood, indices: indices.filter(([first]) => inside.has(first)).flat() };
}

/** Area of the section of a closed surface at a height (Green's theorem over the cut triangles), m². */
function sectionArea_m2({ positions, indices }: SurfaceMesh, height_m: number): number {
  let twice = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const corners = [0, 1, 2].map((k) => positions.slice(3 * indices[t + k], 3 * indices[t + k] + 3));
    const above = corners.map((p) => p[1] > height_m);
    const high = above.filter(Boolean).length;
    if (high === 0 || high === 3) continue;
    const lone = above.indexOf(high === 1);
    const [a, b] = [1, 2].map((k) => {
      const [from, to] = [corners[lone], corners[(lone + k) % 3]];
      const share = (height_m - from[1]) / (to[1] - from[1]);
      return [0, 2].map((axis) => from[axis] + share * (to[axis] - from[axis]));
    });
    twice += (high === 1 ? 1 : -1) * (a[0] * b[1] - a[1] * b[0]);
  }
  return Math.abs(twice) / 2;
}

const top_m = (meshes: SurfaceMesh[]): number =>
  Math.max(...meshes.map(({ positions }) => positions.reduce((top, y, i) => (i % 3 === 1 ? Math.max(top, y) : top), 0)));

const ASKED: (Individual & { dbh_cm: number })[] = [
  { species: "oak", form: "open", seed: 1, height_m: 16, dbh_cm: 43 },
  { species: "oak", form: "open", seed: 2, height_m: 9, dbh_cm: 30 },
  { species: "spruce", form: "forest", seed: 0, height_m: 28, dbh_cm: 33 },
  { species: "birch", form: "open", seed: 4294967295, height_m: 20, dbh_cm: 27 },
  { species: "willow", form: "forest", seed: 77, height_m: 11, dbh_cm: 13 },
  { species: "apricot", form: "open", seed: 5, height_m: 5, dbh_cm: 15 },
];

describe.each(ASKED)("$species, $form, seed $seed", (asked) => {
  const grown = growIndividual(asked);

  it("has the height and the diameter that were asked for", () => {
    expect(Math.abs(top_m([grown.wood, grown.twigs, grown.leaves]) / asked.height_m - 1)).toBeLessThan(2e-3);
    const area_m2 = sectionArea_m2(stemOf(grown.wood), BREAST_HEIGHT_M);
    const dbh_cm = 100 * Math.sqrt((4 * area_m2) / Math.PI);
    expect(dbh_cm / asked.dbh_cm).toBeGreaterThan(0.98);
    expect(dbh_cm / asked.dbh_cm).toBeLessThan(1.02);
  });

  it("fits into the indices of a mesh, with finite numbers only", () => {
    for (const { positions, normals, indices } of [grown.wood, grown.twigs, grown.leaves]) {
      expect(positions.length / 3).toBeLessThan(65536);
      expect(Math.max(...indices)).toBeLessThan(positions.length / 3);
      expect([...positions, ...normals].every(Number.isFinite)).toBe(true);
    }
  });

  it("is the same tree for the same seed, another for another", () => {
    expect(growIndividual(asked)).toEqual(grown);
    const other = growIndividual({ ...asked, seed: (asked.seed + 1) % 2 ** 32 });
    const axes = (nodes: typeof grown.nodes) => nodes.map(({ position }) => position.toArray());
    expect(axes(other.nodes)).not.toEqual(axes(grown.nodes));
  });
});

it.each([
  [{ species: "elm" }, /No species "elm".*choose one of poplar/],
  [{ seed: 1.5 }, /seed is 1.5/],
  [{ seed: -1 }, /seed is -1/],
  [{ height_m: 60 }, /60 m is out of range for English oak: choose 6.4 to 25.6 m/],
  [{ dbh_cm: 5 }, /diameter of 5 cm is out of range/],
  [{ height_m: Number.NaN }, /out of range/],
])("refuses %o in words", (change, words) => {
  expect(() => growIndividual({ ...ASKED[0], ...change })).toThrow(words);
});

it("grows the same tree in a context without Node and without a page, as in a browser's worker", async () => {
  const build = await rolldown({
    input: fileURLToPath(new URL("../../tools/species/individual.ts", import.meta.url)),
    platform: "browser",
    plugins: [withoutPictures],
    onLog: (_, log) => {
      throw new Error(log.message); // among others: a module of Node that is not there
    },
  });
  const { output } = await build.generate({ format: "iife", name: "generator" });
  await build.close();
  const grow = `${output[0].code}; JSON.stringify(generator.growIndividual(${JSON.stringify(ASKED[0])}))`;
  expect(runInNewContext(grow)).toBe(JSON.stringify(growIndividual(ASKED[0])));
});

describe("a size that a species cannot have", () => {
  const tall: Individual = { species: "oak", form: "open", seed: 3, height_m: 80, dbh_cm: 900 };

  it("is refused, or becomes the nearest one", () => {
    expect(() => growIndividual(tall)).toThrow(/out of range for English oak: choose 6\.4 to 25\.6 m/);
    const grown = growIndividual({ ...tall, nearest_size: true });
    expect(top_m([grown.leaves])).toBeCloseTo(25.6, 1);
  });

  it("follows from the height where the diameter is not known", () => {
    const usual = growIndividual({ ...tall, height_m: 12, dbh_cm: null });
    const given = growIndividual({ ...tall, height_m: 12, dbh_cm: 2 * 100 * 0.212 * (12 / 16) });
    expect(usual.wood.positions).toEqual(given.wood.positions);
  });
});
