import { describe, expect, it } from "vitest";
import { bearingOf, strainColours } from "../../../web/src/page/overlays/treeStrain";

const SECTION = { height_m: 4.2, x_m: 0, z_m: 0, diameter_cm: 20, moment_nm: 1, strain: 0.002, stress_mpa: 10 };
/** A stem of three points, and a twig on its second. */
const ANSWER = {
  points_m: [[0, 0, 0], [0, 2, 0], [0, 4, 0], [1, 3, 0]] as [number, number, number][],
  parent: [-1, 0, 1, 1],
  strain: [null, 0.001, 0.002, null],
  rupture_strain: 0.0061,
  wind_m_s: 15,
  direction_deg: 0,
  breast_height_strain: 0.0012,
  largest: { stem: SECTION, boughs: null },
  base_moment_nm: 1,
  top_displacement_m: 1,
  load_factor: 0.1,
  weight_share: 1,
  caution: "No substitute for an inspection.",
};

describe("strain of a tree", () => {
  it("has a link for every point but the root; where nothing is computed it is that before", () => {
    const bearing = bearingOf(ANSWER, "bare");
    expect([...bearing.links]).toEqual([0, 1, 1, 2, 1, 3]);
    expect(Array.from(bearing.strain, (one) => Math.round(1e4 * one))).toEqual([10, 20, 10]);
    expect(bearing.largest).toBe(0.002);
    expect(bearing.words).toBe(
      "Steady wind of 15 m/s, bare. White: no strain, red: 2.00 mm/m, in the stem 4.2 m up. At 1.3 m: 1.20 mm/m. " +
        "Green wood breaks at about 6.10 mm/m. No substitute for an inspection.",
    );
  });

  it("names the bough if that bears most, and leaves out what a low tree does not have", () => {
    const boughs = { ...SECTION, strain: 0.003, height_m: 6 };
    const { words, largest } = bearingOf(
      { ...ANSWER, breast_height_strain: null, largest: { stem: SECTION, boughs } },
      "leaf",
      1.5,
    );
    expect(largest).toBe(0.003);
    expect(words).toContain("in leaf. White: no strain, red: 3.00 mm/m, in a bough 9.0 m up. Green wood");
  });

  it("says so if there is no stem", () => {
    expect(() => bearingOf({ ...ANSWER, largest: { stem: null, boughs: null } }, "leaf")).toThrow("no stem");
  });

  it("goes from white to red, and stays red above the largest", () => {
    const colours = strainColours(Float32Array.of(0, 0.001, 0.002, 0.01), 0.002);
    const green = [0, 1, 2, 3].map((link) => colours[3 * link + 1]);
    expect(green[0]).toBeGreaterThan(green[1]);
    expect(green[1]).toBeGreaterThan(green[2]);
    expect(green[3]).toBe(green[2]);
  });
});
