import { describe, expect, test } from "vitest";
import { nodeLayout, poseStride } from "../../web/src/nodeLayout";
import { meanCrownDisplacement_m } from "../../web/src/sway";
import { dynamicPressure } from "../../web/src/wind";
import type { Frame } from "../../web/src/wire";
import { JumpBlend } from "../../web/src/worker/blend";
import { speedFromPressure } from "../../web/src/worker/groupWind";
import { PoseSum } from "../../web/src/worker/poseSum";
import { PoseTimeline } from "../../web/src/worker/timeline";

describe("node target", () => {
  test.each([
    [500, 400, 4096],
    [700, 10_000, 4096],
    [3000, 2000, 2048],
    [1, 1, 2048],
  ])("%i nodes of %i trees fit a side of %i, or say how many do", (nodes, trees, side) => {
    const layout = nodeLayout(nodes, trees, side);
    expect(layout.width).toBe(2 ** layout.shift);
    expect(Math.max(layout.width, layout.height)).toBeLessThanOrEqual(side);
    expect(layout.capacity >= trees || layout.width * layout.height === side * side).toBe(true);
  });

  test("a row has room for the modes and the wind", () => {
    expect([1, 3, 4, 11, 12].map(poseStride)).toEqual([4, 4, 8, 12, 16]);
  });
});

describe("stream of poses", () => {
  const frame = (key: boolean, values: number[]): Frame => ({
    type: "frame",
    seq: 0,
    time_s: 0,
    key,
    groups: [{ count: 2, modes: 2, values: key ? Int32Array.from(values) : Int16Array.from(values) }],
  });

  test("deltas add to the key frame; a delta before it is refused", () => {
    const sum = new PoseSum([{ count: 2, scale: Float32Array.of(0.5, 2) }]);
    expect(sum.add(frame(false, [1, 1, 1, 1]))).toBe(false);
    expect(sum.add(frame(true, [100_000, 2, 3, 4]))).toBe(true);
    expect(sum.add(frame(false, [-2, 1, 0, -4]))).toBe(true);
    const out = new Float32Array(2 * poseStride(2));
    sum.write([out]);
    expect([out[0], out[1], out[4], out[5]]).toEqual([49_999, 6, 1.5, 0]);
  });

  test("a frame of another forest is refused", () => {
    const sum = new PoseSum([{ count: 3, scale: Float32Array.of(1, 1) }]);
    expect(sum.add(frame(true, [1, 2, 3, 4]))).toBe(false);
  });

  test("shown poses lie between the frames, run evenly and never ahead", () => {
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
    blend.start([Float32Array.of(10)]);
    const shown = Array.from({ length: 60 }, () => {
      const buffer = Float32Array.of(4);
      blend.apply([buffer], 1 / 60);
      return buffer[0];
    });
    expect(shown[0]).toBeGreaterThan(9.9);
    expect(shown[59]).toBe(4);
    shown.slice(1).forEach((value, i) => expect(value).toBeLessThanOrEqual(shown[i]));
  });

  test("another forest starts without fading", () => {
    const blend = new JumpBlend();
    blend.start([Float32Array.of(10, 10)]);
    const buffer = Float32Array.of(4);
    blend.apply([buffer], 0.01);
    expect(buffer[0]).toBe(4);
  });
});

test("wind speed is recovered from its pressure on both sides of the knee", () => {
  for (const speed of [0, 0.5, 4.99, 5, 5.01, 12, 40]) {
    expect(speedFromPressure(dynamicPressure(speed))).toBeCloseTo(speed, 9);
  }
});

test("crown displacement turns with the tree: a quarter turn sends own x to world -z", () => {
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
