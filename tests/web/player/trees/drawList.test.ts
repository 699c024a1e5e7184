import { describe, expect, test } from "vitest";
import { cylinderSeen } from "../../../../web/player/src/trees/culling/culling";
import { LEVEL_SHARES } from "../../../../web/player/src/core/constants";
import { CARD_LEVEL, LEVEL_COUNT, NODE_LEVEL_COUNT } from "../../../../web/player/src/trees/detail";
import { FADE_END } from "../../../../web/player/src/trees/crossFade";
import { DrawList, type View } from "../../../../web/player/src/trees/drawList";
import { placeTrees } from "../../../../web/src/scene/placement";
import { INSTANCE_FLOATS, createInstanceData } from "../../../../web/player/src/trees/instanceData";
import { seededRandom } from "../../seeded";

const BOUNDS = { height_m: 10, radius_m: 3, reach_m: 0 };
const everywhere: View = {
  planes: [],
  eye: { x: 0, y: 5, z: 20 },
  sun: { x: 0.6, y: 0.52915, z: 0.6 },
  levelFrom_m: [30, 60],
  shadow_m: 100,
};
/** A plane that shows only x > 10. */
const halfSpace: View = { ...everywhere, planes: [{ normal: { x: 1, y: 0, z: 0 }, constant: -10 }] };

const instances = createInstanceData(placeTrees(400, 7), () => 0, () => [1, 1, 1, 0]);
const dataOf = (tree: number) => instances.data.subarray(tree * INSTANCE_FLOATS, (tree + 1) * INSTANCE_FLOATS);

function select(view: View, bounds = BOUNDS, list = new DrawList(instances)) {
  list.select(bounds, view);
  return list;
}

const seenTrees = (list: DrawList) =>
  [...list.visible].flatMap((count, level) => [...list.order.subarray(list.start[level], list.start[level] + count)]);
const casterTrees = (list: DrawList) =>
  Array.from({ length: LEVEL_COUNT }, (_, level) =>
    Array.from(
      list.casters.subarray(list.castStart[level], list.castStart[level] + list.castersWithin(level, Infinity)),
      (place) => list.order[place],
    ),
  ).flat();

describe("selection of trees", () => {
  test("without planes every tree is drawn once, near ones in full detail", () => {
    const list = select(everywhere);
    expect(list.drawn).toBe(instances.count);
    expect(new Set(list.order).size).toBe(instances.count);
    for (const tree of list.order.subarray(0, list.visible[0])) {
      const [x, , z, , , , scale] = dataOf(tree);
      expect(list.share[tree] > LEVEL_SHARES[1]).toBe(true);
      if (Math.hypot(x, z - 20) / scale < 29) expect(list.share[tree]).toBe(1);
    }
  });

  test("the trees that are drawn of many, in squares, are those that are drawn of each alone", () => {
    const next = seededRandom(8);
    const many = createInstanceData(placeTrees(3000, 7), (x) => 0.1 * x, () => [1, 1, 1, 0]);
    const list = new DrawList(many);
    let total = 0;
    const alone = Array.from({ length: many.count }, (_, tree) => {
      const data = many.data.slice(tree * INSTANCE_FLOATS, (tree + 1) * INSTANCE_FLOATS);
      return new DrawList({ ...many, count: 1, data });
    });
    for (let k = 0; k < 8; k++) {
      const [turn, eye_m] = [2 * Math.PI * next(), 200 * next()];
      const facing = [-0.7, 0.7].map((side) => {
        const normal = { x: Math.sin(turn + side), y: 0, z: Math.cos(turn + side) };
        return { normal, constant: -eye_m * normal.x };
      });
      const view: View = { ...everywhere, planes: facing, eye: { x: eye_m, y: 5, z: 0 }, shadow_m: 60 };
      list.select({ ...BOUNDS, low_m: k % 2 ? -1 : 0 }, view);
      const drawn = new Set(list.order.subarray(0, list.drawn));
      for (const [tree, single] of alone.entries()) {
        single.select({ ...BOUNDS, low_m: k % 2 ? -1 : 0 }, view);
        if (drawn.has(tree) !== single.drawn > 0) expect(drawn.has(tree), `view ${k}, tree ${tree}`).toBe(single.drawn > 0);
      }
      expect(drawn.size).toBeLessThan(2500);
      total += drawn.size;
    }
    expect(total).toBeGreaterThan(1000);
  });

  test("trees out of view are omitted unless their shadow may be visible", () => {
    const list = select(halfSpace);
    const seen = seenTrees(list);
    expect(seen.length).toBeGreaterThan(0);
    expect(list.drawn).toBeLessThan(instances.count);
    for (let tree = 0; tree < instances.count; tree++) {
      if (dataOf(tree)[0] > 10) expect(seen).toContain(tree);
    }
    expect(new Set([...seen, ...casterTrees(list)]).size).toBe(list.drawn);
  });

  test("the ranges of the levels partition the order", () => {
    const list = select(halfSpace);
    let at = 0;
    for (let level = 0; level < NODE_LEVEL_COUNT; level++) {
      expect(list.start[level]).toBe(at);
      at += list.visible[level] + list.hidden[level];
    }
    expect(at).toBe(list.drawn);
  });

  test("trees that are cards only have a level of their own, unless they cast shadows", () => {
    const list = select({ ...everywhere, cardsFrom_m: 30, shadow_m: 10 });
    const cardsOnly = new Set(list.order.subarray(list.start[CARD_LEVEL], list.drawn));
    expect(list.visible[CARD_LEVEL]).toBe(0);
    expect(cardsOnly.size).toBe(list.hidden[CARD_LEVEL]);
    const all = Array.from({ length: instances.count }, (_, tree) => tree);
    const far = all.filter((tree) => {
      const [x, y, z, , , , scale] = dataOf(tree);
      return Math.hypot(x, y + 5 * scale - 5, z - 20) / scale > 30 * FADE_END && !casterTrees(list).includes(tree);
    });
    expect(new Set(far)).toEqual(cardsOnly);
    expect(cardsOnly.size).toBeGreaterThan(50);
    expect(cardsOnly.size).toBeLessThan(instances.count);
    expect(casterTrees(list).length).toBeGreaterThan(0);
    expect(select({ ...everywhere, cardsFrom_m: 30, shadow_m: 1000 }).hidden[CARD_LEVEL]).toBe(0);
  });

  test("a tree that bends into view is drawn", () => {
    const edge = createInstanceData([{ id: 1, x_m: 4, z_m: 0, yaw_rad: 0, scale: 1 }], () => 0, () => [1, 1, 1, 0]);
    const night = { ...halfSpace, shadow_m: -1000 };
    expect(select(night, BOUNDS, new DrawList(edge)).drawn).toBe(0);
    expect(select(night, { ...BOUNDS, reach_m: 3.5 }, new DrawList(edge)).drawn).toBe(1);
  });

  test("casters whose shadow may fall near come first and are used by the near cascade", () => {
    const list = select(everywhere);
    const near = Array.from({ length: LEVEL_COUNT }, (_, level) => list.castersWithin(level, 20));
    const all = Array.from({ length: LEVEL_COUNT }, (_, level) => list.castersWithin(level, Infinity));
    expect(near.reduce((a, b) => a + b)).toBeLessThan(all.reduce((a, b) => a + b));
    // Brute force: casters with a shadow point within 20 m of the eye.
    const { sun, eye } = everywhere;
    for (let tree = 0; tree < instances.count; tree++) {
      const [x, y, z, , , , scale] = dataOf(tree);
      const slide = (10 * scale) / sun.y;
      const fallsNear = [0, 0.25, 0.5, 0.75, 1].some(
        (t) => Math.hypot(x - t * slide * sun.x - eye.x, y + 10 * scale * (1 - t) - eye.y, z - t * slide * sun.z - eye.z) < 20,
      );
      if (!fallsNear) continue;
      const level = list.level[tree];
      const places = list.casters.subarray(list.castStart[level], list.castStart[level] + near[level]);
      expect(Array.from(places, (place) => list.order[place])).toContain(tree);
    }
  });

  test("a level is kept within the hysteresis", () => {
    const list = select(everywhere);
    const before = list.level.slice();
    // Slightly farther away, then slightly nearer.
    for (const z of [20.4, 20, 19.6]) select({ ...everywhere, eye: { x: 0, y: 5, z } }, BOUNDS, list);
    list.level.forEach((level, tree) => {
      expect(LEVEL_SHARES[level]).toBeGreaterThanOrEqual(list.share[tree]);
      expect(Math.abs(level - before[tree])).toBeLessThanOrEqual(1);
    });
  });
});

test("a cylinder is visible if one of its points is", () => {
  const random = seededRandom(5);
  for (let round = 0; round < 300; round++) {
    const planes = Array.from({ length: 4 }, () => {
      const normal = { x: random() - 0.5, y: random() - 0.5, z: random() - 0.5 };
      return { normal, constant: 4 * random() - 1 };
    });
    const [x, y, z] = [8 * random() - 4, 2 * random(), 8 * random() - 4];
    const [height, radius] = [1 + 9 * random(), 0.5 + 2 * random()];
    const pointSeen = Array.from({ length: 200 }, () => {
      const angle = 2 * Math.PI * random();
      const [px, py, pz] = [x + radius * Math.cos(angle), y + height * Math.round(random()), z + radius * Math.sin(angle)];
      return planes.every(({ normal, constant }) => normal.x * px + normal.y * py + normal.z * pz + constant >= 0);
    }).some(Boolean);
    if (pointSeen) expect(cylinderSeen(planes, x, y, z, height, radius)).toBe(true);
  }
});
