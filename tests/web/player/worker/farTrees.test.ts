/** Parts of the simulation levels: coarse models, turns, packets and poses on their way. */
import { expect, test } from "vitest";
import { CoarseForest } from "../../../../web/player/src/core/modal/coarseForest";
import { ModalForest } from "../../../../web/player/src/core/modal/modalForest";
import { EasedPoses } from "../../../../web/player/src/core/motion/easedPoses";
import type { Changed } from "../../../../web/player/src/core/motion/leveledTrees";
import { packPoses, packetBytes } from "../../../../web/player/src/core/motion/posePacket";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { FAR_LEVELS, FramePace, SimulationLevels } from "../../../../web/player/src/core/motion/simulationLevels";
import { drawnMotion } from "../../../../web/player/src/core/table/drawnMotion";
import { FAR_COORDINATES, leadingCoordinates } from "../../../../web/player/src/core/table/leadingCoordinates";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { golden } from "../../golden";
import { seededRandom } from "../../seeded";

const TABLE = decodeTable(golden("pole.safetensors"));
const { modes, dt_s } = TABLE.metadata;
const OSCILLATORS = TABLE.modal.step.length / 6;
const STRIDE = poseStride(modes);

test("distant trees have the coordinates of the coarsest level: the first ones and that by which a bent tree loses height", () => {
  expect([...leadingCoordinates(30, 24, 7)]).toEqual([0, 1, 2, 3, 4, 5, 24]);
  expect([...leadingCoordinates(30, 24, 40)]).toEqual(Array.from({ length: 30 }, (_, k) => k));
  expect([...leadingCoordinates(16, 16, 7)]).toEqual([0, 1, 2, 3, 4, 5, 6]);
  expect([...leadingCoordinates(5, 4, 7)]).toEqual([0, 1, 2, 3, 4]);
  const { coordinates } = drawnMotion(TABLE).levels[4];
  expect([...coordinates]).toEqual([...leadingCoordinates(modes, OSCILLATORS, FAR_COORDINATES)]);
});

test.each([2, 4, 8])("a coarse step of a linear tree is exactly %i table steps", (steps) => {
  const force = TABLE.modal.force.map(() => 0);
  const pose = TABLE.modal.pose.map(() => 0);
  const drag = { dragPoint: new Float32Array(0), dragShape: new Float32Array(0), dragPlace: new Float32Array(0) };
  const table = { ...TABLE, modal: { ...TABLE.modal, force, pose, ...drag } };
  const [full, coarse] = [new ModalForest(table, 1, true), new CoarseForest(table, 1, [steps])];
  for (const forest of [full, coarse]) forest.setTrees([0], [0], [0.4], [1]);
  const out = new Float32Array(modes);
  let largest = 0;
  for (let k = 0; k < 40; k++) {
    for (let n = 0; n < steps; n++) full.advance(dt_s, [20], [9]);
    coarse.advanceFar(0, steps * dt_s, 0, 20, 9, out, 0);
    // what is displayed is one step behind: one table step there, `steps` of them here
    if (k === 0) continue;
    for (const at of coarse.coordinates) {
      const shown = coarseNow(coarse, at);
      largest = Math.max(largest, Math.abs(shown));
      expect(shown).toBeCloseTo(fullNow(full, at), 4);
    }
  }
  expect(largest).toBeGreaterThan(0.01);
});

interface State {
  readonly now: ArrayLike<number>;
  readonly own: number;
  readonly d: number;
}
/** A coordinate after the last step. */
function coarseNow(forest: ModalForest, coordinate: number): number {
  const { now, own, d } = forest as unknown as State;
  return now[coordinate < d ? coordinate : own + coordinate - d];
}
const fullNow = coarseNow;

test.each([30, 60, 120])("at %i frames per second every distant tree has its turn as often as its level says, near ones always", (hz) => {
  const count = 900;
  const x = Float32Array.from({ length: count }, (_, k) => k);
  const left: number[] = [];
  const levels = new SimulationLevels(x, new Float32Array(count), (tree) => left.push(tree));
  const pace = new FramePace();
  levels.see([0, 0]);
  levels.keepNear([700]);
  const turns = new Uint32Array(count);
  const perFrame: number[] = [];
  for (let frame = 0; frame < 16 * hz; frame++) {
    pace.next(1 / hz);
    const { near, far, periods } = levels.begin(frame / hz, pace);
    expect(periods).toEqual([hz / 7.5, hz / 3.75, hz / 1.875, hz / 0.9375]);
    for (const tree of [...near, ...far.flatMap((trees) => [...trees])]) turns[tree]++;
    perFrame.push(far.reduce((sum, { length }) => sum + length, 0));
  }
  const often = (tree: number) => turns[tree] / 16;
  expect([0, 149, 700].map(often)).toEqual([hz, hz, hz]);
  expect([150, 299].map(often)).toEqual([7.5, 7.5]);
  expect([300, 499].map(often)).toEqual([3.75, 3.75]);
  expect([500, 699, 701, 849].map(often)).toEqual([1.875, 1.875, 1.875, 1.875]);
  expect([850, 899].map(often)).toEqual([0.9375, 0.9375]);
  expect(left).toHaveLength(count - 151);
  // blocks of 32 trees, of four levels
  expect(Math.max(...perFrame) - Math.min(...perFrame)).toBeLessThanOrEqual(4 * 32);
});

test("trees out of view are stepped less often, but not those near the eye", () => {
  const hz = 60;
  const count = 700;
  const x = Float32Array.from({ length: 2 * count }, (_, k) => k - count);
  const levels = new SimulationLevels(x, new Float32Array(2 * count), () => {});
  const pace = new FramePace();
  levels.see([0, 0, 1, 0, Math.cos(0.8)]);
  const turns = new Uint32Array(2 * count);
  for (let frame = 0; frame < 16 * hz; frame++) {
    pace.next(1 / hz);
    const { near, far } = levels.begin(frame / hz, pace);
    for (const tree of [...near, ...far.flatMap((trees) => [...trees])]) turns[tree]++;
  }
  const often = (place_m: number) => turns[count + place_m] / 16;
  expect([0, 149, 150, 299, 300, 499, 500, 699].map(often)).toEqual([hz, hz, 7.5, 7.5, 3.75, 3.75, 1.875, 1.875]);
  expect([-1, -79, -84, -166, -167, -277, -278, -472, -473].map(often)).toEqual([hz, hz, 7.5, 7.5, 3.75, 3.75, 1.875, 1.875, 0.9375]);
});

test("trees keep their level until they are clearly nearer, and none waits where the clock jumps", () => {
  const levels = new SimulationLevels(Float32Array.of(155), Float32Array.of(0), () => {});
  const pace = new FramePace();
  const isNear = (viewer: number, frames = 64) => {
    levels.see([viewer, 0]);
    let near = false;
    for (let k = 0; k < frames; k++) {
      pace.next(1 / 60);
      near = levels.begin(pace.frame / 60, pace).near.length > 0;
    }
    return near;
  };
  expect([0, 10, 20, 10, 0].map((viewer) => isNear(viewer))).toEqual([false, false, true, true, false]);
  const usual_s = 4 / 60;
  levels.stepTo(0, 100, usual_s);
  expect(levels.stepTo(0, 100 + usual_s, usual_s)).toBeCloseTo(usual_s, 9);
  expect(levels.stepTo(0, 100 + usual_s, usual_s)).toBe(0);
  for (const jump_s of [-60, 60]) {
    expect(levels.stepTo(0, 100 + jump_s, usual_s)).toBe(usual_s);
    expect(levels.stepTo(0, 100 + jump_s + usual_s, usual_s)).toBeCloseTo(usual_s, 9);
  }
});

test("a packet brings near poses exactly and distant ones within half a unit, which are reached evenly", () => {
  const next = seededRandom(3);
  const count = 5;
  const coordinates = leadingCoordinates(modes, OSCILLATORS, FAR_COORDINATES);
  const shown = new EasedPoses(count, modes, coordinates);
  const poses = Float32Array.from({ length: count * STRIDE }, () => 4 * next() - 2);
  const start = { row: 0, near: 0, far: 0 };
  const group = { poses, stride: STRIDE, modes };
  const all = packPoses([{ ...group, changed: null }], null);
  shown.begin();
  shown.take(all, 0, { ...start });
  expect([...shown.poses]).toEqual([...poses]);
  const before = poses.slice();
  poses.forEach((_, k) => { poses[k] += next() - 0.5; });
  const far = [Uint32Array.of(1), Uint32Array.of(), Uint32Array.of(4)];
  const changed: Changed = { near: Uint32Array.of(2), far, periods: [4, 8, 16], coordinates };
  const packet = packPoses([{ ...group, changed }], all);
  expect(packetBytes([{ ...group, changed }])).toBe(4 * STRIDE + 4 + 2 * (2 * (FAR_COORDINATES + 1) + 4));
  shown.begin();
  shown.take(packet, 0, { ...start });
  const pose = (of: Float32Array, tree: number) => [...of.subarray(tree * STRIDE, (tree + 1) * STRIDE)];
  expect(pose(shown.poses, 2)).toEqual(pose(poses, 2));
  expect(pose(shown.poses, 0)).toEqual(pose(before, 0));
  for (const k of coordinates) expect(Math.abs(shown.poses[STRIDE + k] - poses[STRIDE + k])).toBeLessThan(2.51e-4);
  expect([1, 4, 2, 0].map((tree) => shown.share(tree))).toEqual([1 / 4, 1 / 16, 1, 1]);
  const nothing: Changed = { near: Uint32Array.of(), far: [], periods: [], coordinates };
  for (let k = 0; k < 2; k++) {
    shown.begin();
    shown.take(packPoses([{ ...group, changed: nothing }], null), 0, { ...start });
  }
  const data = Float32Array.from(coordinates, (k) => shown.poses[STRIDE + k]);
  shown.easer(coordinates)(1, data, 0);
  for (const [at, k] of coordinates.entries()) {
    const [from, to] = [before[STRIDE + k], poses[STRIDE + k]];
    expect(Math.abs(data[at] - (from + 0.75 * (to - from)))).toBeLessThan(2.51e-4);
  }
});

test("frames that last no time leave distant trees as they are", () => {
  const placement = Float32Array.of(10, 0, 0, 1, 400, 0, 0, 1, 900, 0, 1, 1.2);
  const group = { key: "pole", table: TABLE, records: null, placement, ids: [0, 1, 2], sha256: "", compliance: null };
  const motion = new LocalMotion([group], new WindField(PRESETS.breeze), { method: "modal", poseEasing: null }, 0);
  const out = [new Float32Array(3 * STRIDE)];
  motion.advance(0, out);
  motion.see([0, 0]);
  for (let frame = 0; frame < 200; frame++) motion.advance(1 / 60, out);
  const before = out[0].slice();
  expect(Math.abs(before[2 * STRIDE])).toBeGreaterThan(0);
  for (let frame = 0; frame < 40; frame++) {
    motion.see([0, 0]);
    motion.advance(0, out);
    expect(motion.changed[0]?.far).toEqual([]);
  }
  expect([...out[0]]).toEqual([...before]);
  expect(FAR_LEVELS[0].from_m).toBeGreaterThan(10);
});
