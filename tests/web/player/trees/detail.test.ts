import { describe, expect, test } from "vitest";
import { LEVEL_SHARES, MOST_LEAF_GROWTH } from "../../../../web/player/src/core/constants";
import { componentCentres, connectedComponents, holders, weldedComponents } from "../../../../web/player/src/trees/mesh/components";
import {
  branchBases,
  grownLeaf,
  leafGrowth,
  leafRanks,
  levelFor,
  pieceSize,
  rankedIndex,
  sharesOf,
  woodRanks,
} from "../../../../web/player/src/trees/detail";
import { seededRandom } from "../../seeded";
import { roundNormals } from "../../../../web/player/src/trees/mesh/foliage";

/** `count` separate quads; the k-th has side 1 + k/count and stands at x = 10 k. */
function quads(count: number) {
  const positions = new Float32Array(count * 12);
  const index: number[] = [];
  for (let k = 0; k < count; k++) {
    const side = 1 + k / count;
    positions.set([10 * k, 0, 0, 10 * k + side, 0, 0, 10 * k + side, side, 0, 10 * k, side, 0], k * 12);
    index.push(4 * k, 4 * k + 1, 4 * k + 2, 4 * k, 4 * k + 2, 4 * k + 3);
  }
  return { positions, index, pieces: connectedComponents(index, count * 4) };
}

describe("levels of detail", () => {
  test("pieces are found and numbered in order", () => {
    const { pieces, positions } = quads(50);
    expect(pieces.count).toBe(50);
    expect([...pieces.ofVertex.slice(0, 5)]).toEqual([0, 0, 0, 0, 1]);
    expect(componentCentres(pieces, positions)[3]).toBeCloseTo(10 + 1.02 / 2, 4);
  });

  test("the triangles of a level are a prefix that contains every visible piece at its share", () => {
    const { pieces, index } = quads(2000);
    const ranks = leafRanks(pieces);
    const ranked = rankedIndex(index, (v) => ranks[pieces.ofVertex[v]]);
    expect([...ranked.index].sort((a, b) => a - b)).toEqual([...index].sort((a, b) => a - b));
    LEVEL_SHARES.forEach((share, level) => {
      const kept = new Set(Array.from(ranked.index.subarray(0, ranked.counts[level]), (v) => pieces.ofVertex[v]));
      ranks.forEach((rank, piece) => expect(kept.has(piece)).toBe(pieceSize(rank, share) > 0));
      expect(kept.size / pieces.count).toBeLessThan(1.35 * share + 0.01);
    });
  });

  test("no popping: sizes change continuously with distance, also where the level changes", () => {
    const first_m = 50;
    let level = 255;
    let before = new Float64Array(100).fill(1);
    let largest = 0;
    for (let distance = 40; distance < 600; distance += 0.05) {
      const share = sharesOf([first_m, 120])(distance);
      level = levelFor(share, level);
      const sizes = Float64Array.from({ length: 100 }, (_, k) => {
        const size = pieceSize(k / 100, share);
        const drawn = pieceSize(k / 100, LEVEL_SHARES[level]) > 0;
        return drawn ? size * leafGrowth(share) : 0;
      });
      largest = Math.max(largest, ...sizes.map((size, k) => Math.abs(size - before[k])));
      before = sizes;
    }
    expect(largest).toBeLessThan(0.06);
    expect(level).toBe(LEVEL_SHARES.length - 1);
  });

  test("the crown area is preserved up to the growth limit", () => {
    for (const share of [1, 0.7, 0.45, 0.25, 0.18]) {
      const area = Array.from({ length: 5000 }, (_, k) => (pieceSize(k / 5000, share) * leafGrowth(share)) ** 2);
      expect(area.reduce((a, b) => a + b) / 5000).toBeCloseTo(1, 0);
    }
  });

  test("remaining leaves grow uniformly about their centre, up to the limit", () => {
    const random = seededRandom(5);
    for (let k = 0; k < 300; k++) {
      const point = () => [random() - 0.5, random() - 0.5, random() - 0.5];
      const [a, b] = [point(), point()];
      const corners = [point(), point(), point(), point()].map((p, i) => p.map((x, axis) => x + 3 * (i & 1 ? a : b)[axis]));
      const middle = [0, 1, 2].map((axis) => corners.reduce((sum, c) => sum + c[axis], 0) / 4);
      const share = 0.02 + 0.98 * random();
      const rank = random() * share;
      const grown = corners.map((corner) => grownLeaf(corner, middle, rank, share));
      const edges = (of: number[][]) => of.map((c, i) => Math.hypot(...c.map((x, axis) => x - of[(i + 1) % 4][axis])));
      const factors = edges(grown).map((edge, i) => edge / edges(corners)[i]);
      for (const factor of factors) {
        expect(factor).toBeCloseTo(factors[0], 9);
        expect(factor).toBeLessThanOrEqual(MOST_LEAF_GROWTH + 1e-9);
      }
      const moved = [0, 1, 2].map((axis) => grown.reduce((sum, c) => sum + c[axis], 0) / 4);
      moved.forEach((x, axis) => expect(x).toBeCloseTo(middle[axis], 9));
    }
    expect(MOST_LEAF_GROWTH).toBeLessThanOrEqual(2.5);
  });

  test("a card is bound to one node; a large piece keeps one node per vertex", () => {
    const { pieces } = quads(3);
    expect([...holders(pieces)]).toEqual([0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8]);
    const sheet = connectedComponents(Array.from({ length: 60 }, (_, i) => Math.floor(i / 3) + (i % 3)), 22);
    expect([...holders(sheet)]).toEqual(Array.from({ length: 22 }, (_, v) => v));
  });

  test("the level does not flicker at a boundary", () => {
    const levels: number[] = [];
    let level = 255;
    for (let k = 0; k < 40; k++) {
      level = levelFor(LEVEL_SHARES[1] * (1 + 0.02 * (k % 2 === 0 ? 1 : -1)), level);
      levels.push(level);
    }
    expect(new Set(levels.slice(1)).size).toBe(1);
  });

  test("a branch with a texture seam is one piece", () => {
    const positions = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 5, 5, 5, 6, 5, 5, 5, 6, 5];
    const pieces = weldedComponents([0, 1, 2, 3, 4, 5, 6, 7, 8], positions);
    expect(pieces.count).toBe(2);
    expect([...pieces.ofVertex]).toEqual([0, 0, 0, 0, 0, 0, 1, 1, 1]);
  });

  test("the longest branches rank first; wood of few pieces stays complete", () => {
    const { pieces, positions } = quads(100);
    const ranks = woodRanks(pieces, positions);
    expect(ranks[99]).toBe(0);
    expect(ranks[0]).toBeCloseTo(0.99, 6);
    const one = connectedComponents([0, 1, 2], 3);
    expect([...woodRanks(one, new Float32Array(9))]).toEqual([0]);
  });

  test("a branch shrinks to its base at the trunk", () => {
    const { pieces, positions } = quads(3);
    expect([...branchBases(pieces, positions)]).toEqual([0, 0, 0, 10, 0, 0, 20, 0, 0]);
  });
});

describe("light in the crown", () => {
  const centre = { x: 0, y: 5, z: 0 };
  const positions = Float32Array.of(3, 5, 0, 0.1, 5, 0, 0, 9, 0);

  test("normals point outwards and have unit length", () => {
    const normals = roundNormals(positions, Float32Array.of(-1, 0, 0, 0, 0, 1, 0, -1, 0), centre);
    expect(normals[0]).toBeGreaterThan(0.9);
    expect(normals[7]).toBeGreaterThan(0.9);
    for (let v = 0; v < 3; v++) expect(Math.hypot(...normals.subarray(v * 3, v * 3 + 3))).toBeCloseTo(1, 5);
  });
});
