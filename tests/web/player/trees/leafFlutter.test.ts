import { expect, test } from "vitest";
import { connectedComponents, petioles } from "../../../../web/player/src/trees/mesh/components";
import { leafFreedom } from "../../../../web/player/src/trees/mesh/foliage";
import { leafFrequency_hz, LEAF_FLUTTER, MOST_RAD } from "../../../../web/player/src/trees/leafFlutter";

/** Two cards: a small leaf of 0.1 m, and a piece of 2 m. */
const CARDS = Float32Array.of(0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 5, 0, 0, 7, 0, 0, 5, 2, 0);
const PIECES = connectedComponents([0, 1, 2, 3, 4, 5], 6);

test("leaves turn about their first vertex, large pieces less", () => {
  expect([...petioles(PIECES, CARDS)]).toEqual([0, 0, 0, 5, 0, 0]);
  const freedom = leafFreedom(PIECES, CARDS);
  expect(new Set(freedom.subarray(0, 3))).toEqual(new Set([1]));
  const most_rad = MOST_RAD * freedom[3];
  expect(2 * most_rad).toBeLessThan(0.2); // m, the tip of the large piece
});

test("leaves flutter at 2 to 8 Hz, slower on long petioles, as torsion springs do", () => {
  expect(leafFrequency_hz(0.06)).toBe(2);
  expect(leafFrequency_hz(0.2)).toBe(2);
  expect(leafFrequency_hz(0.001)).toBe(8);
  expect(leafFrequency_hz(0.01) / leafFrequency_hz(0.04)).toBeCloseTo(2, 12); // sqrt of the ratio of the lengths
});

test("the shader turns leaves rigidly", () => {
  // Rodrigues' rotation as in the shader keeps lengths, so that cards do not shear.
  const axis = [Math.cos(1), 0.45, Math.sin(1)].map((value) => 0.9119 * value);
  expect(Math.hypot(...axis)).toBeCloseTo(1, 4);
  expect(LEAF_FLUTTER).toContain("axis * (dot(axis, arm) * (1.0 - c))");
});
