/** Which sprays are drawn leaf by leaf: those whose foot is close to the eye, of all visible trees. */
import { expect, test } from "vitest";
import { LEVEL_SHARES } from "../../../../web/player/src/core/constants";
import {
  CLOSE_FLOATS,
  fillClose,
  type HeldSprays,
  type SprayRoom,
} from "../../../../web/player/src/trees/culling/closeLeaves";
import { DrawList, type View } from "../../../../web/player/src/trees/drawList";
import { createInstanceData, INSTANCE_FLOATS } from "../../../../web/player/src/trees/instanceData";
import { WHOLE_SHARE } from "../../../../web/player/src/trees/jointAttribute";
import { leanOf } from "../../../../web/player/src/trees/lean";
import { SPRAY_FLOATS } from "../../../../web/player/src/trees/mesh/singleLeaves";
import { seededRandom } from "../../seeded";

const SEED = 67;
console.log("seed", SEED);
const random = seededRandom(SEED);
const SPRAYS = 300;
const NODES = 9;
const SIZE = { height_m: 8, radius_m: 3 };
const CLOSE_M = 4;

const places = Array.from({ length: 60 }, (_, id) => ({
  id,
  x_m: 40 * random() - 20,
  z_m: 40 * random() - 20,
  yaw_rad: 6.3 * random(),
  scale: 0.6 + random(),
}));
const instances = createInstanceData(places, () => 0.3, () => [1, 1, 1, 0], true);

const sprays = new Float32Array(SPRAYS * SPRAY_FLOATS);
for (let k = 0; k < sprays.length; k++) sprays[k] = random();
for (let k = 0; k < SPRAYS; k++) {
  const [angle, reach] = [6.3 * random(), SIZE.radius_m * random()];
  sprays.set(
    [reach * Math.cos(angle), SIZE.height_m * random(), reach * Math.sin(angle)],
    k * SPRAY_FLOATS,
  );
}
const integers = (length: number, below: number) =>
  Uint16Array.from({ length }, () => Math.floor(below * random()));
const floats = (length: number) => Float32Array.from({ length }, () => random());
const motion = {
  vertexJoint: integers(500, 20),
  jointNodes: integers(40, NODES),
  jointShare: floats(20),
  jointRest_m: floats(60),
  levels: LEVEL_SHARES.map(() => ({ of: integers(NODES, NODES) })),
} as unknown as HeldSprays["motion"];
const held: HeldSprays = {
  ...SIZE,
  leans: true,
  sprays,
  shapeOf: Uint8Array.from({ length: SPRAYS }, () => Math.floor(3 * random())),
  hold: Uint32Array.from({ length: SPRAYS }, () => Math.floor(500 * random())),
  motion,
};
const texels = LEVEL_SHARES.map((_, level) => ({ first: 1000 * level, trees: 60, nodes: 7 }));

/** The foot of a spray of a tree as the vertex shader places it, without motion. */
function footOf(tree: number, spray: number): [number, number, number] {
  const [x0, y0, z0, , cos, sin, scale] = instances.data.subarray(tree * INSTANCE_FLOATS);
  const [x, y, z] = sprays.subarray(spray * SPRAY_FLOATS);
  const [leanX, leanZ] = leanOf(x0, z0);
  const up = scale * y;
  return [x0 + cos * x + sin * z + up * leanX, y0 + up, z0 + cos * z - sin * x + up * leanZ];
}

test("all sprays close to the eye are drawn, hardly any others, each as its tree and joint say", () => {
  let drawn = 0;
  for (let round = 0; round < 40; round++) {
    const eye = { x: 40 * random() - 20, y: 8 * random(), z: 40 * random() - 20 };
    const list = new DrawList(instances);
    const view: View = {
      planes: [],
      eye,
      sun: { x: 0, y: 1, z: 0 },
      levelFrom_m: [6, 20],
      near_m: 5,
      shadow_m: 10,
    };
    list.select({ ...SIZE, reach_m: 0 }, view);
    const rooms: SprayRoom[] = [0, 1, 2].map(() => ({ data: new Float32Array(0), count: 0 }));
    fillClose(rooms, held, list, instances.data, texels, eye, CLOSE_M);
    const found = new Set<string>();
    rooms.forEach(({ data, count }, shape) => {
      for (let k = 0; k < count; k++) {
        const one = data.subarray(k * CLOSE_FLOATS, (k + 1) * CLOSE_FLOATS);
        const tree = places.findIndex(({ x_m }) => Math.fround(x_m) === one[0]);
        const own = one.subarray(INSTANCE_FLOATS + 8);
        const spray = held.shapeOf.findIndex(
          (_, s) => sprays[s * SPRAY_FLOATS] === own[0] && sprays[s * SPRAY_FLOATS + 1] === own[1],
        );
        expect(held.shapeOf[spray]).toBe(shape);
        expect(own).toEqual(sprays.subarray(spray * SPRAY_FLOATS, (spray + 1) * SPRAY_FLOATS));
        found.add(`${tree} ${spray}`);
        const level = list.level[tree];
        const place = list.order.indexOf(tree) - list.start[level];
        expect(one[3]).toBe(1000 * level + 7 * place);
        const joint = motion.vertexJoint[held.hold[spray]];
        const { of } = motion.levels[level];
        const [first, second] = [of[motion.jointNodes[2 * joint]], of[motion.jointNodes[2 * joint + 1]]];
        const share = first === second ? 0 : Math.round(WHOLE_SHARE * motion.jointShare[joint]);
        expect([...one.subarray(12, 15)]).toEqual([first, second, share]);
        expect(one.subarray(16, 19)).toEqual(motion.jointRest_m.subarray(3 * joint, 3 * joint + 3));
      }
    });
    for (let tree = 0; tree < places.length; tree++) {
      for (let spray = 0; spray < SPRAYS; spray++) {
        const [x, y, z] = footOf(tree, spray);
        const distance_m = Math.hypot(x - eye.x, y - eye.y, z - eye.z);
        const is = found.has(`${tree} ${spray}`);
        if (distance_m < CLOSE_M) expect(is).toBe(true);
        if (distance_m > 1.25 * CLOSE_M) expect(is).toBe(false);
        drawn += is ? 1 : 0;
      }
    }
  }
  expect(drawn).toBeGreaterThan(1000);
});
