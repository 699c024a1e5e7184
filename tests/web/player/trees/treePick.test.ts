import { vertexAt } from "../../../../web/src/page/pulling/grabPoint";
import { expect, test } from "vitest";
import { INSTANCE_FLOATS, createInstanceData } from "../../../../web/player/src/trees/instanceData";
import { ballEntry, type PickGroup, pickTree } from "../../../../web/player/src/trees/treePick";
import type { TableMotion } from "../../../../web/player/src/worker/protocol";
import { seededRandom } from "../../seeded";

const BOUNDS = { height_m: 10, radius_m: 3, reach_m: 1 };

/** Three nodes along a trunk; the only mode moves the top node along the tree's x axis. */
const motion = {
  modes: 1,
  stride: 4,
  nodes: 3,
  rest_m: Float32Array.of(0, 1, 0, 0, 5, 0, 0, 9, 0),
  basis: Float32Array.from({ length: 36 }, (_, i) => (i === 24 ? 1 : 0)),
  turn: new Float32Array(36),
  parent: Uint16Array.of(0, 1, 2),
  jointNodes: Uint16Array.of(0, 0, 1, 1, 2, 2),
  jointShare: new Float32Array(3),
  jointRest_m: Float32Array.of(0, 1, 0, 0, 5, 0, 0, 9, 0),
} as unknown as TableMotion;

function group(places: { x_m: number; z_m: number; yaw_rad?: number; scale?: number }[], moves = true): PickGroup {
  const instances = createInstanceData(
    places.map((place, id) => ({ id, yaw_rad: 0, scale: 1, ...place })),
    () => 0,
    () => [1, 1, 1, 0],
  );
  return {
    instances,
    bounds: BOUNDS,
    motion: moves ? motion : null,
    jointRadius_m: Float32Array.of(1, 1, 1),
    poses: new Float32Array(places.length * 4),
    exaggeration: 1,
  };
}

const ray = (x: number, y: number, z: number, dx: number, dy: number, dz: number) => {
  const length = Math.hypot(dx, dy, dz);
  return { from: { x, y, z }, to: { x: dx / length, y: dy / length, z: dz / length } };
};

test("the entry into a sphere is the first root of |o + t d| = r", () => {
  expect(ballEntry(-10, 0, 0, 1, 0, 0, 2)).toBe(8);
  expect(ballEntry(-10, 3, 0, 1, 0, 0, 2)).toBe(Number.POSITIVE_INFINITY);
  expect(ballEntry(10, 0, 0, 1, 0, 0, 2)).toBe(Number.POSITIVE_INFINITY);
  expect(ballEntry(1, 0, 0, 1, 0, 0, 2)).toBe(0);
});

test("a tree is picked where its exaggerated motion is drawn", () => {
  const trees = group([{ x_m: 0, z_m: 0 }]);
  trees.poses?.set([1.5]); // moves the top node by 1.5 m, drawn at 4.5 m
  const at = (x: number, exaggeration: number) =>
    pickTree([{ ...trees, bounds: { ...BOUNDS, reach_m: 5 }, exaggeration }], ray(x, 9, 20, 0, 0, -1));
  expect(at(4.5, 3)?.distance_m).toBeCloseTo(19, 2);
  expect(at(4.5, 1)).toBeNull();
  expect(at(1.5, 1)?.distance_m).toBeCloseTo(19, 2);
  expect(at(1.5, 3)).toBeNull();
});

test("the nearer of two trees in line is picked", () => {
  const found = pickTree([group([{ x_m: 20, z_m: 0 }, { x_m: 10, z_m: 0 }])], ray(0, 5, 0, 1, 0, 0));
  expect(found).toMatchObject({ group: 0, tree: 1 });
  expect(found?.distance_m).toBeCloseTo(9, 2);
});

test("a ray through a gap in the nearer tree picks the one behind", () => {
  const found = pickTree([group([{ x_m: 20, z_m: 0, scale: 1.5 }, { x_m: 10, z_m: 0 }])], ray(0, 7.5, 0, 1, 0, 0));
  expect(found?.tree).toBe(0);
});

test("a tree is picked at its displaced position, with its rotation and scale", () => {
  const one = group([{ x_m: 0, z_m: 0, yaw_rad: Math.PI / 2, scale: 2 }]);
  const down = ray(0, 40, -6, 0, -1, 0); // a quarter turn maps tree x to world -z: 3 m times 2
  expect(pickTree([one], down)).toBeNull();
  const bounds = { ...BOUNDS, reach_m: 4 };
  (one.poses as Float32Array)[0] = 3;
  const found = pickTree([{ ...one, bounds }], down);
  expect(found?.tree).toBe(0);
  expect(found?.distance_m).toBeCloseTo(40 - (18 - 0.12) - 2, 1);
});

test("a static tree is picked by its crown", () => {
  const still = [group([{ x_m: 10, z_m: 0 }], false)];
  expect(pickTree(still, ray(0, 5, 0, 1, 0, 0))?.distance_m).toBeCloseTo(7, 1);
  expect(pickTree(still, ray(0, 9.5, 2.5, 1, 0, 0))).toBeNull();
});

test("the pick among many trees equals the nearest of the single picks", () => {
  const random = seededRandom(11);
  const places = Array.from({ length: 60 }, () => ({
    x_m: 80 * random(),
    z_m: 40 * random() - 20,
    yaw_rad: 6 * random(),
    scale: 0.7 + random(),
  }));
  const all = group(places);
  const single = places.map((place) => group([place]));
  for (let k = 0; k < 40; k++) {
    const one = ray(-5, 6, 0, 1, 0.1 * random() - 0.05, random() - 0.5);
    const distances = single.map((tree) => pickTree([tree], one)?.distance_m ?? Number.POSITIVE_INFINITY);
    const nearest = Math.min(...distances);
    const found = pickTree([all], one);
    expect(found?.distance_m ?? Number.POSITIVE_INFINITY).toBe(nearest);
    if (found) expect(found.tree).toBe(distances.indexOf(nearest));
  }
  expect(all.instances.data.length).toBe(60 * INSTANCE_FLOATS);
});

test("the vertex at a node hangs on the nearest joint, also where no joint belongs to the node", () => {
  const motion = {
    rest_m: new Float32Array([0, 0, 0, 0, 5, 0, 0, 10, 0]),
    jointRest_m: new Float32Array([0, 1, 0, 0, 9, 0, 0, 5, 0]),
    vertexJoint: new Uint16Array([0, 0, 2, 1, 1]),
  };
  expect([0, 1, 2].map((node) => vertexAt(motion, node))).toEqual([0, 2, 3]);
});
