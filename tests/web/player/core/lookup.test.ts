import { describe, expect, test } from "vitest";
import { PaperForest, gaussian } from "../../../../web/player/src/core/motion/paperSearch";
import type { Records } from "../../../../web/player/src/core/table/records";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { CALM_BREEZE } from "../../../../web/player/src/core/wind/presets";
import { golden, goldenJson } from "../../golden";
import { windPressure } from "../../windPressure";

interface Walk {
  pose_easing: number;
  trees: { x_m: number[]; z_m: number[]; yaw_rad: number[]; scale: number[] };
  records: number[][];
  poses: number[][];
}

const TABLE = decodeTable(golden("pole.safetensors"));
const RECORDS = TABLE.paper as Records;
const STRONG = { ...CALM_BREEZE, mean_speed_m_s: 9, gustiness: 0.8, convection_speed_m_s: 6, seed: 3 };
const TURNED = { ...STRONG, mean_speed_m_s: 6, direction_deg: 250, seed: 4 };
const STILL = { ...CALM_BREEZE, mean_speed_m_s: 0 };

function walk({ pose_easing, trees, records, poses }: Walk): void {
  const count = trees.x_m.length;
  const forest = new PaperForest(TABLE, RECORDS, count, { poseEasing: pose_easing });
  forest.setTrees(trees.x_m, trees.z_m, trees.yaw_rad, trees.scale);
  const px = new Float32Array(count);
  const pz = new Float32Array(count);
  const every = Math.ceil(records.length / poses.length);
  for (let frame = 0; frame < records.length; frame++) {
    const wind = frame < 150 ? STRONG : frame < 280 ? TURNED : STILL;
    windPressure(wind, trees.x_m, trees.z_m, frame / 30, px, pz, TABLE.metadata.streamlined_exponent);
    forest.advance(1 / 30, px, pz);
    expect(Array.from(forest.record), `records of frame ${frame}`).toEqual(records[frame]);
    if (frame % every === 0) {
      expect(forest.q, `poses of frame ${frame}`).toEqual(Float32Array.from(poses[frame / every]));
    }
  }
}

describe("reproduces the golden forest", () => {
  for (const golden of goldenJson<Walk[]>("walk.json")) {
    test(`same records and bit-identical poses, pose easing ${golden.pose_easing}`, () => walk(golden));
  }
});

test("the Gaussian agrees with Math.exp", () => {
  for (let exponent = 0; exponent < 60; exponent += 0.013) {
    expect(gaussian(exponent)).toBeCloseTo(-Math.expm1(-exponent), 13);
  }
  expect(gaussian(0)).toBe(0);
});

test("a forest in still air never moves", () => {
  const forest = new PaperForest(TABLE, RECORDS, 3);
  const still = new Float32Array(3);
  for (let frame = 0; frame < 200; frame++) forest.advance(1 / 30, still, still);
  expect(forest.q.every((value) => value === 0)).toBe(true);
});

test("a tree of scale 2 steps through its table at half the rate", () => {
  const forest = new PaperForest(TABLE, RECORDS, 2);
  forest.setTrees([0, 0], [0, 0], [0, 0], [1, 2]);
  const wind = new Float32Array(2).fill(20);
  const dt = TABLE.metadata.dt_s;
  for (let frame = 0; frame < 8; frame++) forest.advance(dt, wind, wind);
  expect(forest.record[0] - forest.record[1]).toBe(4);
});
