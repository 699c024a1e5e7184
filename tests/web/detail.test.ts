import { describe, expect, test } from "vitest";
import { componentCentres, connectedComponents, weldedComponents } from "../../web/src/scene/components";
import { growLeaves, thinLeaves, thinWood } from "../../web/src/scene/detail";
import { leafReach, openness, roundNormals } from "../../web/src/scene/foliage";

/** `count` separate quads, the k-th of side 1 + k/count, standing at x = 10 k. */
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

  test("a coarser level's leaves are among the finer level's, and about as many as asked for", () => {
    const { pieces, index } = quads(2000);
    const fine = new Set(thinLeaves(index, pieces, 0.42));
    const coarse = thinLeaves(index, pieces, 0.14);
    expect(coarse.every((vertex) => fine.has(vertex))).toBe(true);
    expect(coarse.length / index.length).toBeCloseTo(0.14, 1);
  });

  test("leaves grow about their own centres so that the area stays", () => {
    const { pieces, positions } = quads(10);
    const grown = growLeaves(positions, pieces, 0.25);
    expect(grown[3] - grown[0]).toBeCloseTo(2 * (positions[3] - positions[0]), 5);
    const before = componentCentres(pieces, positions);
    componentCentres(pieces, grown).forEach((centre, i) => expect(centre).toBeCloseTo(before[i], 4));
  });

  test("a branch that a seam cuts is one branch", () => {
    const positions = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 5, 5, 5, 6, 5, 5, 5, 6, 5];
    const pieces = weldedComponents([0, 1, 2, 3, 4, 5, 6, 7, 8], positions);
    expect(pieces.count).toBe(2);
    expect([...pieces.ofVertex]).toEqual([0, 0, 0, 0, 0, 0, 1, 1, 1]);
  });

  test("the longest branches stay; wood in one piece stays whole", () => {
    const { pieces, positions, index } = quads(100);
    const kept = thinWood(index, positions, pieces, 0.1);
    expect(Math.min(...kept)).toBeGreaterThanOrEqual(4 * 89);
    const one = connectedComponents([0, 1, 2], 3);
    expect([...thinWood([0, 1, 2], new Float32Array(9), one, 0.1)]).toEqual([0, 1, 2]);
  });
});

describe("light in the crown", () => {
  const centre = { x: 0, y: 5, z: 0 };
  const positions = Float32Array.of(3, 5, 0, 0.1, 5, 0, 0, 9, 0);

  test("normals point outward and have length one", () => {
    const normals = roundNormals(positions, Float32Array.of(-1, 0, 0, 0, 0, 1, 0, -1, 0), centre);
    expect(normals[0]).toBeGreaterThan(0.9);
    expect(normals[7]).toBeGreaterThan(0.9);
    for (let v = 0; v < 3; v++) expect(Math.hypot(...normals.subarray(v * 3, v * 3 + 3))).toBeCloseTo(1, 5);
  });

  test("the outside is more open than the inside", () => {
    const [outside, inside, top] = openness(positions, centre, 4);
    expect(outside).toBeGreaterThan(inside);
    expect(top).toBeGreaterThan(outside);
  });

  test("a leaf's first vertex holds still, its farthest is free", () => {
    const { pieces, positions: leaf } = quads(2);
    const reach = leafReach(pieces, leaf);
    expect([reach[0], reach[2], reach[4], reach[6]]).toEqual([0, 1, 0, 1]);
  });
});
