import { describe, expect, test } from "vitest";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { ModalForest } from "../../../../web/player/src/core/modal/modalForest";
import { golden, goldenJson } from "../../golden";

interface Sway {
  frames: number;
  every: number;
  trees: { x_m: number[]; z_m: number[]; yaw_rad: number[]; scale: number[] };
  poses: number[][];
}

const TABLE = decodeTable(golden("pole.safetensors"));
const LINEAR = decodeTable(golden("pole-linear.safetensors"));

function still(forest: ModalForest, frames: number): void {
  const calm = new Float32Array(forest.count);
  for (let frame = 0; frame < frames; frame++) forest.advance(TABLE.metadata.dt_s, calm, calm);
}

describe.each([
  ["in the kernel", false],
  ["in plain TypeScript", true],
])("%s", (_, plain) => {
  test.each([
    ["with all couplings", TABLE, "sway.json"],
    ["with linear oscillators alone", LINEAR, "sway-linear.json"],
  ])("agrees with Python to 1e-5 of the height over 10,000 frames, %s", (_words, table, file) => {
    const { frames, every, trees, poses } = goldenJson<Sway>(file);
    const count = trees.x_m.length;
    const forest = new ModalForest(table, count, plain);
    expect(forest.compiled).toBe(!plain);
    forest.setTrees(trees.x_m, trees.z_m, trees.yaw_rad, trees.scale);
    const px = new Float32Array(count);
    const pz = new Float32Array(count);
    for (let frame = 0; frame < frames; frame++) {
      const strength = frame < 9000 ? 12 : 0;
      for (let i = 0; i < count; i++) {
        px[i] = strength * (1 + Math.cos(0.05 * frame + trees.x_m[i])) * (1 + 0.5 * Math.cos(0.013 * frame));
        pz[i] = strength * Math.cos(0.031 * frame + trees.z_m[i]);
      }
      forest.advance(1 / 30, px, pz);
      if (frame % every !== every - 1) continue;
      const expected = poses[(frame + 1) / every - 1];
      // One unit of q moves the farthest vertex by 1 m.
      const worst = expected.reduce((most, value, k) => Math.max(most, Math.abs(value - forest.q[k])), 0);
      expect(worst / table.metadata.height_m, `frame ${frame}`).toBeLessThan(1e-5);
    }
  });

  test("still air: a forest at rest never moves, a displaced one comes to rest exactly", () => {
    const forest = new ModalForest(TABLE, 2, plain);
    still(forest, 50);
    expect(forest.q.every((value) => value === 0)).toBe(true);
    const wind = new Float32Array([20, 5]);
    for (let frame = 0; frame < 100; frame++) forest.advance(TABLE.metadata.dt_s, wind, wind);
    expect(Math.abs(forest.q[0])).toBeGreaterThan(0.01);
    still(forest, 3000);
    expect(forest.q.every((value) => value === 0)).toBe(true);
  });

  test("far beyond the sampled wind the motion stays bounded and the extrapolation ratio exceeds 1", () => {
    const forest = new ModalForest(TABLE, 1, plain);
    const storm = new Float32Array([10 * TABLE.modal.limits[2]]);
    for (let frame = 0; frame < 3000; frame++) {
      const turn = frame % 40 < 20 ? 1 : -1;
      forest.advance(TABLE.metadata.dt_s, [turn * storm[0]], storm);
      expect(forest.extrapolationRatio[0]).toBeGreaterThan(1);
    }
    expect(forest.q.every(Number.isFinite)).toBe(true);
    still(forest, 3000);
    expect(forest.q.every((value) => value === 0)).toBe(true);
  });

  test("a forest continues from poses and their rates", () => {
    const trees = [[3, -4], [5, 6], [0.4, 2], [1, 1.3]] as const;
    const [first, second] = [new ModalForest(TABLE, 2, plain), new ModalForest(TABLE, 2, plain)];
    for (const forest of [first, second]) forest.setTrees(...trees);
    const frame_s = TABLE.metadata.dt_s / 2;
    const calm = [0, 0];
    for (let frame = 0; frame < 200; frame++) first.advance(frame_s, [20, 10], [4, -8]);
    for (let frame = 0; frame < 9; frame++) first.advance(frame_s, calm, calm);
    const before = first.q.slice();
    first.advance(frame_s, calm, calm);
    const { modes } = TABLE.metadata;
    for (let i = 0; i < 2; i++) {
      const pose = first.q.slice(i * modes, (i + 1) * modes);
      const rate = pose.map((value, k) => (value - before[i * modes + k]) / frame_s);
      second.startAt(i, pose, rate, 0, 0);
    }
    let [worst, largest] = [0, 0];
    for (let frame = 0; frame < 60; frame++) {
      for (const forest of [first, second]) forest.advance(frame_s, calm, calm);
      first.q.forEach((value, k) => {
        worst = Math.max(worst, Math.abs(value - second.q[k]));
        largest = Math.max(largest, Math.abs(value));
      });
    }
    expect(largest).toBeGreaterThan(0.01);
    expect(worst / largest).toBeLessThan(0.3);
  });

  test("a tree of scale 2 sways at half the frequency", () => {
    const wind = [15, 15];
    const small = new ModalForest(TABLE, 1, plain);
    const large = new ModalForest(TABLE, 1, plain);
    large.setTrees([0], [0], [0], [2]);
    for (let frame = 0; frame < 8; frame++) small.advance(TABLE.metadata.dt_s, wind, wind);
    for (let frame = 0; frame < 16; frame++) large.advance(TABLE.metadata.dt_s, wind, wind);
    expect(large.q).toEqual(small.q);
  });
});
