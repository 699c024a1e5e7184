import { describe, expect, test } from "vitest";
import { placeTrees } from "../../web/src/scene/planting";
import { INSTANCE_FLOATS, LEVEL_COUNT, makeDrawList, makeStand, selectTrees, type View } from "../../web/src/scene/stand";

const BOUNDS = { height_m: 10, radius_m: 3 };
const everywhere: View = {
  planes: [],
  eye: { x: 0, y: 5, z: 20 },
  sun: { x: 0.6, y: 0.5, z: 0.6 },
  levelFrom_m: [30, 60],
  shadow_m: 100,
};
/** Sees only what lies at x > 10. */
const halfSpace: View = { ...everywhere, planes: [{ normal: { x: 1, y: 0, z: 0 }, constant: -10 }] };

const stand = makeStand(placeTrees(200, 7), () => 0, () => [1, 1, 1, 0]);

function select(view: View) {
  const list = makeDrawList(stand.count);
  selectTrees(stand, BOUNDS, view, new Uint8Array(stand.count), list);
  return list;
}

describe("selection of trees", () => {
  test("without planes every tree is drawn once, the near ones in detail", () => {
    const list = select(everywhere);
    expect(list.drawn).toBe(stand.count);
    expect(new Set(list.order).size).toBe(stand.count);
    const near = list.order.subarray(0, list.visible[0]);
    for (const tree of near) {
      const [x, , z] = stand.data.subarray(tree * INSTANCE_FLOATS);
      const scale = stand.data[tree * INSTANCE_FLOATS + 6];
      expect(Math.hypot(x, z - 20) / scale).toBeLessThan(30);
    }
  });

  test("what cannot be seen is left out unless its shadow may be", () => {
    const list = select(halfSpace);
    const visible = list.visible.reduce((sum, n) => sum + n, 0);
    const shadowOnly = list.shadowOnly.reduce((sum, n) => sum + n, 0);
    expect(list.drawn).toBe(visible + shadowOnly);
    expect(visible).toBeGreaterThan(0);
    expect(list.drawn).toBeLessThan(stand.count);
    const seen = new Set(list.order.subarray(0, list.drawn));
    for (let tree = 0; tree < stand.count; tree++) {
      if (stand.data[tree * INSTANCE_FLOATS] > 10) expect(seen.has(tree)).toBe(true);
    }
  });

  test("the ranges of the levels tile the order", () => {
    const list = select(halfSpace);
    let at = 0;
    for (let level = 0; level < LEVEL_COUNT; level++) {
      expect(list.start[level]).toBe(at);
      at += list.visible[level] + list.shadowOnly[level];
    }
    expect(at).toBe(list.drawn);
  });
});
