/** Dead branches on a round stem whose crown begins at a height. */
import { describe, expect, it } from "vitest";
import { deadBranches } from "../../../../web/src/scene/treeModel/wood/deadBranches";
import { cross, dot, minus, type Point } from "../../../../web/src/scene/treeModel/points";
import { tubesOf } from "../../../../web/src/scene/treeModel/wood/tubes";

const STEM_M = 0.15;
const CROWN_M = 9;
const AROUND = 12;

/** A vertical stem of 16 m and a level bough on its axis. */
function tree(crown_m: number) {
  const [positions, normals, uvs, ofVertex]: number[][] = [[], [], [], []];
  const ring = (piece: number, middle: Point, up: Point, side: Point, radius_m: number, v: number) => {
    const other = cross(up, side);
    for (let k = 0; k <= AROUND; k++) {
      const angle = (2 * Math.PI * (k % AROUND)) / AROUND;
      const out = side.map((s, i) => Math.cos(angle) * s + Math.sin(angle) * other[i]);
      positions.push(...middle.map((m, i) => m + radius_m * out[i]));
      normals.push(...out);
      uvs.push(k / AROUND, v);
      ofVertex.push(piece);
    }
  };
  for (let k = 0; k <= 8; k++) ring(0, [0, 2 * k, 0], [0, 1, 0], [1, 0, 0], STEM_M, k);
  for (let k = 0; k <= 2; k++) ring(1, [k, crown_m, 0], [1, 0, 0], [0, 1, 0], 0.04, k);
  const wood = {
    positions: Float32Array.from(positions),
    normals: Float32Array.from(normals),
    uvs: Float32Array.from(uvs),
    index: [],
  };
  return { wood, tubes: tubesOf(wood, ofVertex) };
}

const { wood, tubes } = tree(CROWN_M);
const dead = deadBranches(wood, tubes, true);
if (!dead) throw new Error("no dead branches");
const at = (values: Float32Array, v: number): Point => [values[3 * v], values[3 * v + 1], values[3 * v + 2]];
const vertices = [...dead.hold.keys()];

describe("dead branches", () => {
  it("stand on the stem below the crown, out of reach from the ground", () => {
    for (const v of vertices) {
      const [x, y, z] = dead.feet.subarray(4 * v, 4 * v + 3);
      expect(Math.hypot(x, z)).toBeLessThan(1e-6);
      expect(y).toBeGreaterThan(1.2);
      expect(y).toBeLessThan(CROWN_M);
      expect(dead.feet[4 * v + 3]).toBeGreaterThanOrEqual(0);
      expect(dead.feet[4 * v + 3]).toBeLessThan(1);
    }
    const inside = vertices.filter((v) => Math.hypot(dead.positions[3 * v], dead.positions[3 * v + 2]) < STEM_M);
    expect(inside.length).toBeGreaterThan(vertices.length / 6); // the feet are in the wood
  });

  it("are moved by the side of the stem on which they stand", () => {
    for (const v of vertices.filter((_, k) => k % 15 > 9)) {
      const [end, on] = [at(dead.positions, v), at(wood.positions, dead.hold[v])];
      expect(end[0] * on[0] + end[2] * on[2]).toBeGreaterThan(0);
      expect(Math.abs(on[1] - dead.feet[4 * v + 1])).toBeLessThanOrEqual(1 + 1e-6); // the nearer ring
    }
  });

  it("face outwards", () => {
    for (let i = 0; i < dead.index.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => at(dead.positions, dead.index[i + k]));
      const facing = cross(minus(b, a), minus(c, a));
      expect(dot(facing, at(dead.normals, dead.index[i]))).toBeGreaterThan(0);
    }
  });

  it("are fewer on broadleaves, and absent below a low crown or without boughs", () => {
    expect(deadBranches(wood, tubes, false)?.hold.length).toBeLessThan(dead.hold.length / 2);
    const low = tree(1);
    expect(deadBranches(low.wood, low.tubes, true)).toBeNull();
    expect(deadBranches(wood, tubes.slice(0, 1), true)).toBeNull();
    expect(deadBranches(wood, [], true)).toBeNull();
  });
});
