import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { describe, expect, test } from "vitest";
import { readGlb } from "../../../../tools/species/glb";
import { hasVariant, limbKeysOf } from "../../../../web/src/scene/treeModel/limbKeys";
import { COMMON_KEY, MISSING_BRANCH_SHARE } from "../../../../web/player/src/trees/variantShader";
import { bareShoots } from "../../../../web/src/scene/treeModel/bareShoots";
import { limbsOf, type PartGeometry, STEM_LIMB } from "../../../../web/player/src/trees/mesh/limbs";
import { connectedComponents, weldedComponents } from "../../../../web/player/src/trees/mesh/components";
import { random } from "../../golden";

const path = (file: string) => fileURLToPath(new URL(`../../../../assets/species/${file}`, import.meta.url));

interface Skeleton {
  points_m: [number, number, number][];
  parent: number[];
  branch: number[];
  level: number[];
}

/** Parts of a shipped render mesh, as the page reads them. */
async function partsOf(name: string): Promise<PartGeometry[]> {
  const document = await readGlb(new Uint8Array(readFileSync(path(`shipped/${name}.glb`))));
  return document
    .getRoot()
    .listMeshes()
    .map((mesh) => {
      const [primitive] = mesh.listPrimitives();
      const kind = mesh.getName().split("_")[0] as PartGeometry["kind"];
      const positions = primitive.getAttribute("POSITION")?.getArray() as Float32Array;
      const index = primitive.getIndices()?.getArray() as Uint32Array;
      const pieces =
        kind === "leaves"
          ? connectedComponents(index, positions.length / 3)
          : weldedComponents(index, positions);
      return { kind, positions, index, pieces };
    });
}

/** The limb (branch of level 1) of every branch of the generator's own skeleton. */
function truth({ parent, branch, level }: Skeleton): Map<number, number> {
  const limb = new Map<number, number>();
  branch.forEach((id, node) => {
    if (limb.has(id)) return;
    const below = parent[node];
    if (level[node] === 0) limb.set(id, STEM_LIMB);
    else limb.set(id, level[node] === 1 ? id : (limb.get(branch[below]) ?? STEM_LIMB));
  });
  return limb;
}

/**
 * Least share of the pieces that are found on their own limb. The boughs of the spruce leave the stem close to each other at the top, and
 * twigs begin on them where they leave it (found: 0.907).
 */
const CLEAR_SHARE = 0.97;
const DENSE_SHARE = 0.9;

describe.each(["poplar", "maple", "apricot", "willow", "spruce", "poplar-forest", "maple-forest", "apricot-forest", "pine-forest"])("%s", (name) => {
  test("the limbs of branches, twigs and leaves are those of the generator", { timeout: 60_000 }, async () => {
    const skeleton = JSON.parse(readFileSync(path(`${name}.skeleton.json`), "utf8")) as Skeleton;
    const limb = truth(skeleton);
    const parts = await partsOf(name);
    const found = limbsOf(parts);
    /** The branch of the nearest point of the skeleton, sampled every 5 cm. */
    const samples = skeleton.points_m.flatMap((point, node) => {
      const below = skeleton.parent[node];
      if (below < 0) return [];
      const from = skeleton.points_m[below];
      const steps = Math.ceil(Math.hypot(...point.map((x, axis) => x - from[axis])) / 0.05);
      return Array.from({ length: steps }, (_, s) => ({
        at: point.map((x, axis) => x + ((from[axis] - x) * s) / steps),
        branch: skeleton.branch[node],
      }));
    });
    const nearest = (at: number[]) => {
      let best = samples[0];
      let least = Number.POSITIVE_INFINITY;
      for (const sample of samples) {
        const distance = (sample.at[0] - at[0]) ** 2 + (sample.at[1] - at[1]) ** 2 + (sample.at[2] - at[2]) ** 2;
        if (distance < least) [least, best] = [distance, sample];
      }
      return best.branch;
    };
    parts.forEach(({ kind, pieces, positions }, p) => {
      if (kind === "leaves") return;
      // Numbers differ: those of one limb of the generator must have one number, and the stem's none.
      const votes = new Map<string, number>();
      const first = new Map<number, number>();
      pieces.ofVertex.forEach((piece, v) => first.set(piece, first.get(piece) ?? v));
      for (const [piece, v] of first) {
        const ring = [0, 1, 2].map((axis) => (positions[3 * v + axis] + positions[3 * v + 3 + axis] + positions[3 * v + 6 + axis]) / 3);
        // Wood: a branch is identified by its tip, twigs by their base.
        const vertices = [...pieces.ofVertex.keys()].filter((u) => pieces.ofVertex[u] === piece);
        const tip = vertices.at(-1) as number;
        const at = kind === "twigs" ? ring : [0, 1, 2].map((axis) => positions[3 * tip + axis]);
        const key = `${limb.get(nearest(at))} is ${found[p][piece]}`;
        votes.set(key, (votes.get(key) ?? 0) + 1);
      }
      const best = new Map<string, number>();
      for (const [key, count] of votes) {
        const [own] = key.split(" ");
        best.set(own, Math.max(best.get(own) ?? 0, count));
      }
      const right = [...best.values()].reduce((sum, count) => sum + count, 0);
      expect(right / first.size).toBeGreaterThan(name === "spruce" ? DENSE_SHARE : CLEAR_SHARE);
    });
  });
});

test("every tree lacks the same share of the limbs, and no two neighbours the same ones", () => {
  const keys = limbKeysOf(25);
  const place = random(5);
  const sets = Array.from({ length: 60 }, () => {
    const [x, z] = [200 * (place() - 0.5), 200 * (place() - 0.5)];
    expect(hasVariant(COMMON_KEY, x, z)).toBe(true);
    return [...keys].map((key) => (hasVariant(key, x, z) ? "1" : "0")).join("");
  });
  for (const set of sets) expect(Math.abs([...set].filter((has) => has === "0").length / 25 - MISSING_BRANCH_SHARE)).toBeLessThan(0.05);
  expect(new Set(sets).size).toBeGreaterThan(15);
});

describe("bare shoots", () => {
  /** Two cards of 0.4 m x 0.5 m: one upright, one lying. */
  const positions = Float32Array.from(
    [
      [[-0.2, 3, 0], [0.2, 3, 0], [0.2, 3.5, 0], [-0.2, 3.5, 0]],
      [[1, 2, -0.2], [1, 2, 0.2], [1.5, 2, 0.2], [1.5, 2, -0.2]],
    ].flat(2),
  );
  const { index, card, bases, ranks, normals, ...shoots } = bareShoots({ positions, first: Uint32Array.of(0, 4) });

  test("begin at the foot of their card, stay within it, and are bound to it", () => {
    expect(new Set(card)).toEqual(new Set([0, 4]));
    card.forEach((first, v) => {
      const middle = [0, 1, 2].map((axis) => (positions[3 * first + axis] + positions[3 * (first + 2) + axis]) / 2);
      const apart = Math.hypot(...middle.map((x, axis) => x - shoots.positions[3 * v + axis]));
      expect(apart).toBeLessThan(0.45);
    });
    const foot = [0, 3, 0];
    const first = shoots.positions.subarray(0, 9);
    for (const axis of [0, 1, 2]) expect((first[axis] + first[3 + axis] + first[6 + axis]) / 3).toBeCloseTo(foot[axis], 6);
  });

  test("are thin, face outwards, and shrink to their own base", () => {
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => {
        const v = index[t + k];
        return [0, 1, 2].map((axis) => shoots.positions[3 * v + axis]);
      });
      const [u, w] = [b.map((x, axis) => x - a[axis]), c.map((x, axis) => x - a[axis])];
      const out = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
      const normal = normals.subarray(3 * index[t], 3 * index[t] + 3);
      expect(out[0] * normal[0] + out[1] * normal[1] + out[2] * normal[2]).toBeGreaterThan(0);
      expect(Math.hypot(...u)).toBeLessThan(0.01); // the base of the triangle: across the twig
    }
    for (let v = 0; v < card.length; v += 4) {
      for (let k = 0; k < 3; k++) {
        const apart = [0, 1, 2].map((axis) => shoots.positions[3 * (v + k) + axis] - bases[3 * v + axis]);
        expect(Math.hypot(...apart)).toBeLessThan(0.01);
        expect(ranks[v + k]).toBe(ranks[v]);
      }
    }
    expect([...ranks].every((rank) => rank >= 0 && rank < 1)).toBe(true);
  });
});
