/** Trees that lean: the same shear in places, in rays and in what is picked. */
import { expect, test } from "vitest";
import { toTree, toWorld } from "../../../../web/src/page/pulling/grabPoint";
import { createInstanceData } from "../../../../web/player/src/trees/instanceData";
import { leanOf, MOST_LEAN } from "../../../../web/player/src/trees/lean";
import { leanAt, ownRay } from "../../../../web/player/src/trees/treePick";
import { seededRandom } from "../../seeded";

const SEED = 41;
console.log("seed", SEED);
const random = seededRandom(SEED);
const places = Array.from({ length: 500 }, (_, id) => ({
  id,
  x_m: 400 * random() - 200,
  z_m: 400 * random() - 200,
  yaw_rad: 6.3 * random(),
  scale: 0.6 + random(),
}));
const instances = createInstanceData(places, () => 2, () => [1, 1, 1, 0], true);

test("no tree leans more than the most, in no preferred direction, and most lean visibly", () => {
  const leans = places.map(({ x_m, z_m }) => leanOf(x_m, z_m));
  const sizes = leans.map(([x, z]) => Math.hypot(x, z));
  expect(Math.max(...sizes)).toBeLessThanOrEqual(MOST_LEAN);
  expect(Math.sqrt(sizes.reduce((sum, size) => sum + size ** 2, 0) / sizes.length)).toBeGreaterThan(0.4 * MOST_LEAN);
  for (const axis of [0, 1]) {
    const mean = leans.reduce((sum, lean) => sum + lean[axis], 0) / leans.length;
    expect(Math.abs(mean)).toBeLessThan(0.1 * MOST_LEAN);
  }
});

test("a place of a tree and its place in the world follow from each other, and its foot and height stay", () => {
  for (const [tree, { x_m, z_m, scale }] of places.entries()) {
    const own: [number, number, number] = [4 * random() - 2, 15 * random(), 4 * random() - 2];
    const world = toWorld(instances, tree, own);
    toTree(instances, tree, world).forEach((at, axis) => expect(at).toBeCloseTo(own[axis], 4));
    const upright = toWorld({ ...instances, leans: false }, tree, own);
    const lean = leanOf(Math.fround(x_m), Math.fround(z_m));
    expect(world[0] - upright[0]).toBeCloseTo(lean[0] * scale * own[1], 4);
    expect(world[2] - upright[2]).toBeCloseTo(lean[1] * scale * own[1], 4);
    expect(world[1]).toBe(upright[1]);
    const foot = toWorld(instances, tree, [0, 0, 0]);
    expect([foot[0], foot[2]]).toEqual([Math.fround(x_m), Math.fround(z_m)]);
  }
});

test("a ray meets a point of a tree at the same distance in the world and in the tree's frame", () => {
  for (let tree = 0; tree < places.length; tree++) {
    const own: [number, number, number] = [random(), 15 * random(), random()];
    const [x, y, z] = toWorld(instances, tree, own);
    const from = { x: x + 30 * random() - 15, y: y + 10 * random(), z: z + 20 * random() };
    const far = Math.hypot(x - from.x, y - from.y, z - from.z);
    const to = { x: (x - from.x) / far, y: (y - from.y) / far, z: (z - from.z) / far };
    const [ox, oy, oz, dx, dy, dz, length] = ownRay(instances, tree, { from, to });
    [ox + far * length * dx, oy + far * length * dy, oz + far * length * dz].forEach((at, axis) =>
      expect(at).toBeCloseTo(own[axis], 3),
    );
    expect(Math.hypot(dx, dy, dz)).toBeCloseTo(1, 6);
  }
  expect(leanAt({ ...instances, leans: false }, 3)).toEqual([0, 0]);
});
