import { describe, expect, test } from "vitest";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { levelRows, nodeLayout } from "../../../../web/player/src/trees/nodes/nodeLayout";
import { meanCrownDisplacement_m } from "../../../../web/player/src/core/motion/crownDisplacement";
import { compressed } from "../../../../web/player/src/core/wind/pressure";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { CALM_BREEZE } from "../../../../web/player/src/core/wind/presets";
import { dynamicPressure } from "../../../../web/player/src/core/wind/pressure";
import type { Frame } from "../../../../web/player/src/core/wire/wire";
import { JumpBlend } from "../../../../web/player/src/worker/motion/blend";
import { GroupWind } from "../../../../web/player/src/core/motion/groupWind";
import { JointWind } from "../../../../web/player/src/core/motion/jointWind";
import { PoseSum } from "../../../../web/player/src/worker/stream/poseSum";
import { PoseTimeline } from "../../../../web/player/src/worker/stream/timeline";

describe("node target", () => {
  test.each([
    [500 * 400, 4096],
    [700 * 10_000, 4096],
    [3000 * 1000, 2048],
    [1, 2048],
    [0, 2048],
  ])("%i texels fit into a side of %i", (texels, side) => {
    const layout = nodeLayout(texels, 5, side);
    expect(layout.width).toBe(2 ** layout.shift);
    expect(Math.max(layout.width, layout.height)).toBeLessThanOrEqual(side);
    expect(layout.width * (layout.height - 5)).toBeGreaterThanOrEqual(texels);
  });

  test("every level has its own rows; the farthest trees are omitted if there is no space", () => {
    const layout = { width: 256, shift: 8, height: 20 };
    const rows = levelRows(layout, [100, 30, 8], [20, 30, 1000]);
    expect(rows[0]).toEqual({ row: 0, rows: 8, trees: 20 });
    expect(rows[1]).toEqual({ row: 8, rows: 4, trees: 30 });
    expect(rows[2].row).toBe(12);
    expect(rows[2].trees).toBe((8 * 256) / 8);
    expect(rows[2].row + rows[2].rows).toBe(20);
  });

  test("a row holds the modes and the wind", () => {
    expect([1, 3, 4, 11, 12].map(poseStride)).toEqual([4, 4, 8, 12, 16]);
  });
});

describe("stream of poses", () => {
  const frame = (tick: number, base: number | null, values: number[], quantum = 1): Frame => ({
    type: "frame",
    tick,
    base,
    time_s: 0,
    made_s: 0,
    groups: [
      {
        count: 2,
        modes: 2,
        quantum,
        values: base === null ? Int32Array.from(values) : Int16Array.from(values),
      },
    ],
  });

  test("deltas apply only to their base tick; others are rejected", () => {
    const sum = new PoseSum([{ count: 2, scale: Float32Array.of(0.5, 2) }]);
    expect(sum.add(frame(8, 7, [1, 1, 1, 1]))).toBe(false);
    expect(sum.add(frame(9, null, [100_000, 2, 3, 4]))).toBe(true);
    expect(sum.add(frame(12, 11, [1, 1, 1, 1]))).toBe(false);
    expect(sum.add(frame(12, 9, [-2, 1, 0, -4]))).toBe(true);
    const out = new Float32Array(2 * poseStride(2));
    sum.write([out]);
    expect([out[0], out[1], out[4], out[5]]).toEqual([49_999, 6, 1.5, 0]);
  });

  test("poses are quantized in units of the table's scale", () => {
    const sum = new PoseSum([{ count: 2, scale: Float32Array.of(0.5, 2) }]);
    sum.add(frame(0, null, [1, 2, 3, 4], 8));
    const out = new Float32Array(2 * poseStride(2));
    sum.write([out]);
    expect([out[0], out[1], out[4], out[5]]).toEqual([4, 32, 12, 64]);
  });

  test("a frame of another forest is rejected", () => {
    const sum = new PoseSum([{ count: 3, scale: Float32Array.of(1, 1) }]);
    expect(sum.add(frame(0, null, [1, 2, 3, 4]))).toBe(false);
  });

  test("displayed poses are interpolated, run evenly and never ahead of the stream", () => {
    const timeline = new PoseTimeline([1]);
    const out = [new Float32Array(1)];
    expect(timeline.sample(out)).toBe(false);
    let shownBefore = -1;
    let arrived = 0;
    for (let tick = 0; tick < 300; tick++) {
      const now_s = tick / 60;
      // Frames at 30 Hz, some late by a seeded jitter.
      while (arrived / 30 + 0.01 * ((arrived * 7) % 3) <= now_s) {
        const poses = timeline.take();
        poses[0][0] = arrived / 30;
        timeline.push(arrived / 30, poses);
        arrived++;
      }
      const shown_s = timeline.advance(1 / 60);
      if (!timeline.sample(out)) continue;
      expect(out[0][0]).toBeCloseTo(Math.max(0, shown_s), 4);
      expect(out[0][0]).toBeGreaterThanOrEqual(shownBefore);
      expect(now_s - shown_s).toBeLessThan(0.2);
      shownBefore = out[0][0];
    }
    expect(shownBefore).toBeGreaterThan(4.5);
  });

  test("a change of source fades from the old pose to the new", () => {
    const blend = new JumpBlend();
    blend.start([{ poses: Float32Array.of(10), known: Uint8Array.of(1) }]);
    const shown = Array.from({ length: 80 }, () => {
      const buffer = Float32Array.of(4);
      blend.apply([buffer], 1 / 60);
      return buffer[0];
    });
    expect(shown[0]).toBe(10);
    expect(shown[79]).toBe(4);
    shown.slice(1).forEach((value, i) => expect(value).toBeLessThanOrEqual(shown[i]));
  });

  test("new trees are not blended", () => {
    const blend = new JumpBlend();
    blend.start([{ poses: Float32Array.of(10, 10), known: Uint8Array.of(1, 0) }, null]);
    const buffers = [Float32Array.of(4, 4), Float32Array.of(3)];
    blend.apply(buffers, 0.01);
    expect(buffers.map((buffer) => [...buffer])).toEqual([[10, 4], [3]]);
  });
});

test.each([
  ["clamped", true],
  ["compressed", false],
])("wind of a group: speed at each tree's height, %s pressure, share within the sampled range", (_, clamps) => {
  const placement = Float32Array.of(0, 0, 0, 1, 5, 3, 1, 1.3);
  const field = new WindField({ ...CALM_BREEZE, mean_speed_m_s: 8, gustiness: 0 });
  const peak_pa = dynamicPressure(7, 1.64);
  const wind = new GroupWind(placement, 10, peak_pa, 1.64, clamps);
  new JointWind([wind]).update(field, field.at(3));
  const out = new Float32Array(2 * poseStride(3));
  wind.writeSpeeds(out, 3);
  const [velocityX, velocityZ] = [new Float64Array(2), new Float64Array(2)];
  field.velocity(Float32Array.of(0, 5), Float32Array.of(0, 3), field.at(3), velocityX, velocityZ);
  expect(out[3]).toBeGreaterThan(0);
  expect(out[7]).toBeGreaterThanOrEqual(out[3]);
  expect(wind.extrapolationRatioAt(0)).toBeCloseTo(dynamicPressure(out[3], 1.64) / peak_pa, 6);
  for (const tree of [0, 1]) {
    const held = Math.hypot(wind.pressureX[tree], wind.pressureZ[tree]);
    const felt = dynamicPressure(out[4 * tree + 3], 1.64);
    expect(held).toBeCloseTo(clamps ? Math.min(peak_pa, felt) : peak_pa * compressed(felt / peak_pa), 3);
    expect(Math.atan2(wind.pressureZ[tree], wind.pressureX[tree])).toBeCloseTo(
      Math.atan2(velocityZ[tree], velocityX[tree]),
      6,
    );
  }
  expect(wind.extrapolationRatio).toBeCloseTo(Math.max(wind.extrapolationRatioAt(0), wind.extrapolationRatioAt(1)), 6);
  expect(wind.coverage).toBe([0, 1].filter((tree) => wind.extrapolationRatioAt(tree) <= 1).length / 2);
});

test("crown displacement rotates with the tree: a quarter turn maps tree x to world -z", () => {
  const group = {
    count: 1,
    stride: 4,
    modes: 1,
    crownBasis: Float32Array.of(1, 0, 0),
    placement: Float32Array.of(0, 0, Math.PI / 2, 2),
    poses: Float32Array.of(0.5, 9, 9, 9),
  };
  const [x, y, z] = meanCrownDisplacement_m([group]);
  expect(x).toBeCloseTo(0, 6);
  expect(y).toBe(0);
  expect(z).toBeCloseTo(-1, 6);
  expect(meanCrownDisplacement_m([])).toEqual([0, 0, 0]);
});
