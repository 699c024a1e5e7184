import { expect, test } from "vitest";
import { MOST_TERM_SUMS } from "../../../../web/player/src/core/constants";
import { sumsOf } from "../../../../web/player/src/core/modal/termSums";
import { seededRandom } from "../../seeded";

const [TERMS, D] = [44, 24];

test.each([0, 1, 2, 3, 4, 5])("a force in %i ways is summed to rounding, whatever the units of its terms", (ways) => {
  const next = seededRandom(ways);
  const units = Float64Array.from({ length: TERMS }, () => 10 ** (16 * next() - 12));
  const [left, right] = [TERMS, D].map((rows) => Float64Array.from({ length: rows * ways }, () => 2 * next() - 1));
  const exact = Array.from({ length: TERMS * D }, (_, at) => {
    const [f, k] = [Math.floor(at / D), at % D];
    let sum = 0;
    for (let way = 0; way < ways; way++) sum += left[f * ways + way] * right[k * ways + way];
    return f === 7 ? 0 : units[f] * sum;
  });
  const force = Float32Array.from(exact);
  const sums = sumsOf(force, D);
  if (ways > MOST_TERM_SUMS) {
    expect(sums).toBeNull();
    return;
  }
  expect(sums?.count).toBe(ways);
  for (let f = 0; f < TERMS; f++) {
    const most = Math.max(...force.subarray(f * D, (f + 1) * D).map(Math.abs));
    for (let k = 0; k < D; k++) {
      let sum = 0;
      for (let way = 0; way < ways; way++) sum += (sums?.shares[way * TERMS + f] ?? 0) * (sums?.rows[way * D + k] ?? 0);
      expect(Math.abs(sum - force[f * D + k])).toBeLessThanOrEqual(2 ** -20 * most);
    }
  }
});

test("the largest terms do not hide others", () => {
  const force = new Float32Array(3 * 8);
  force.set([1e6, 0, 0, 0, 0, 0, 0, 0]);
  force.set([0, 1e-6, 0, 0, 0, 0, 0, 0], 8);
  expect(sumsOf(force, 8)?.count).toBe(2);
});
