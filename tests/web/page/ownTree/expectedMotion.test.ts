/** The expected motion of an upload, and the choice of its stiffness. */
import { describe, expect, test } from "vitest";
import {
  defaultLiveliness,
  expectedMotionOf,
  frequency_Hz,
  isAdjustable,
  lengthInWords,
  swaysAt,
  swaysInWords,
} from "../../../../web/src/page/ownTree/expectedMotion";
import { chosenStiffness, factsOf, stiffnessInWords } from "../../../../web/src/page/physics/physics";

const expected = {
  first_frequency_hz: 4,
  typical_frequency_hz: 1,
  lively_frequency_hz: 1,
  default_frequency_hz: 1,
  sway: [
    { wind_m_s: 10, sway_m: 0.002, share: 0.0008 },
    { wind_m_s: 18, sway_m: 0.004, share: 0.0016 },
  ],
  visible: false,
};

describe("expected motion", () => {
  test("is read from an import report and from a build report; junk is none", () => {
    const read = expectedMotionOf({ up_axis: {}, expected });
    expect(read).toMatchObject({ first_Hz: 4, lively_Hz: 1, default_Hz: 1, visible: false });
    const measured = expectedMotionOf({ up_axis: {}, expected: { ...expected, default_frequency_hz: 4 } });
    expect([read, measured].map((one) => one && defaultLiveliness(one))).toEqual([1, 0]);
    expect(expectedMotionOf({ import: { up_axis: {}, expected } })).toEqual(read);
    for (const junk of [null, {}, { up_axis: {}, expected: null }, { up_axis: {}, expected: { sway: 3 } }])
      expect(expectedMotionOf(junk)).toBeNull();
  });

  test("sway follows the reciprocal of the stiffness, frequency its square root", () => {
    const read = expectedMotionOf({ up_axis: {}, expected });
    if (!read) throw new Error("not read");
    expect(isAdjustable(read)).toBe(true);
    expect(frequency_Hz(read, 0)).toBeCloseTo(4);
    expect(frequency_Hz(read, 0.5)).toBeCloseTo(2);
    expect(frequency_Hz(read, 1)).toBeCloseTo(1);
    expect(swaysAt(read, 0)).toEqual(read.sways);
    expect(swaysAt(read, 1)[1].sway_m).toBeCloseTo(0.064);
    expect(isAdjustable({ ...read, lively_Hz: 4 })).toBe(false);
  });

  test("is told in lengths that people use", () => {
    expect([0.0021, 0.064, 2.31].map(lengthInWords)).toEqual(["2 mm", "6 cm", "2.3 m"]);
    expect([0.00001, 0.0094, 0.0096].map(lengthInWords)).toEqual(["less than 0.1 mm", "9 mm", "1 cm"]);
    const little = swaysInWords([{ wind_m_s: 10, sway_m: 2e-6, share: 8e-7 }]);
    expect(little).toBe("less than 0.1 mm (less than 0.001 % of its height) at 10 m/s");
    const words = swaysInWords([{ wind_m_s: 18, sway_m: 0.064, share: 0.0256 }]);
    expect(words).toBe("6 cm (3 % of its height) at 18 m/s");
    const far = swaysInWords([{ wind_m_s: 18, sway_m: 8.7, share: 0.52 }]);
    expect(far).toBe("more than 20 % of its height at 18 m/s");
  });
});

test("a chosen stiffness is shown with the physics of the tree", () => {
  const stiffness = { factor: 0.0625, first_frequency_hz: 1.002, of_wood_hz: 4.01, requested_frequency_hz: 1 };
  const report = { model: { stiffness } };
  expect(chosenStiffness(report)?.factor).toBe(0.0625);
  expect(stiffnessInWords(report)).toContain("1.0 Hz instead of 4.0 Hz");
  expect(factsOf({ height_m: 2, report }, null).find(({ name }) => name === "Stiffness")?.value).toBe("× 0.063");
  expect(stiffnessInWords({ model: {} })).toBe("");
  expect(factsOf({ height_m: 2, report: {} }, null).some(({ name }) => name === "Stiffness")).toBe(false);
});
