import { encode } from "@msgpack/msgpack";
import { describe, expect, test } from "vitest";
import { decodeTracks, poseAt } from "../../../web/src/page/compare/tracks";
import { verdictLines } from "../../../web/src/page/compare/words";
import { assumedOf } from "../../../web/src/page/ownTree/assumed";
import { figuresInWords } from "../../../web/src/page/picking/pickedCard";

const bytes = (...values: number[]) => new Uint8Array(Float32Array.from(values).buffer);
const errors = { max: [0.001, 0.002], hausdorff: [0.0005, 0.001] };
const good = {
  format: "galewood-comparison",
  version: 1,
  frames: 2,
  dt_s: 1 / 30,
  height_m: 10,
  modes: 3,
  pressure_pa: bytes(1, 2, 3, 4),
  tracks: { fem: bytes(1, 2, 3, 4, 5, 6), modal: bytes(0, 0, 0, 1, 1, 1), paper: bytes(9, 9, 9, 9, 9, 9) },
  sway: [0.1, 0.2],
  left_out: [0, 0],
  error: { modal: errors, paper: errors },
  uniform: { sway: [0.08, 0.15], error: { modal: { max: [0.0001, 0.0002], hausdorff: [0, 0.0001] }, paper: errors } },
};

describe("the tracks of a comparison", () => {
  test("are decoded", () => {
    const tracks = decodeTracks(encode(good));
    expect([...tracks.q.fem]).toEqual([1, 2, 3, 4, 5, 6]);
    expect(tracks.gusts.error.paper?.max).toEqual([0.001, 0.002]);
    expect(tracks.uniform.sway).toEqual([0.08, 0.15]);
    expect(tracks.uniform.error.modal.max).toEqual([0.0001, 0.0002]);
  });

  test("may lack the paper's method, for a table without records", () => {
    const { paper: _, ...tracks } = good.tracks;
    const uniform = { sway: [0, 0], error: { modal: errors } };
    const decoded = decodeTracks(encode({ ...good, tracks, error: { modal: errors }, uniform }));
    expect([decoded.q.paper, decoded.gusts.error.paper, decoded.uniform.error.paper]).toEqual([null, null, null]);
    expect(decoded.gusts.error.modal.max).toEqual([0.001, 0.002]);
  });

  test("are told in words: gusts first, then the uniform wind if it differs", () => {
    const { gusts, uniform } = decodeTracks(encode(good));
    const says = "Maximum displacement: 20 % of tree height. Maximum error: 0.2 % of tree height (Hausdorff distance 0.1 %).";
    const [first, second, ...further] = verdictLines(gusts, uniform, "modal");
    expect(first).toBe(`In gusts, as shown. ${says}`);
    expect(second).toMatch(/^In a uniform wind, the same on all branches\. .*displacement: 15 %.*error: 0.02 %/);
    expect(further).toEqual([]);
    const alone = { ...gusts, error: { ...gusts.error, paper: null } };
    expect(verdictLines(alone, uniform, "paper")[0]).toBe(first);
    expect(verdictLines(gusts, gusts, "modal")).toEqual([`In this wind, the same on all branches. ${says}`]);
  });

  test.each([
    ["another version", { version: 2 }],
    ["another format", { format: "else" }],
    ["no frames", { frames: 0 }],
    ["a track of another length", { modes: 4 }],
    ["no errors", { error: {} }],
    ["no uniform wind", { uniform: undefined }],
    ["a sway of another length", { sway: [0.1] }],
  ])("with %s are rejected with a message", (_, change) => {
    expect(() => decodeTracks(encode({ ...good, ...change }))).toThrow("The comparison could not be read");
  });

  test("are interpolated between frames and clamped at the ends", () => {
    const q = Float32Array.from([1, 2, 3, 3, 6, 9]);
    const out = new Float32Array(3);
    for (const [place, expected] of [
      [0.5, [2, 4, 6]],
      [-1, [1, 2, 3]],
      [7, [3, 6, 9]],
    ] as const) {
      poseAt(q, 3, place, out);
      expect([...out]).toEqual(expected);
    }
  });
});

describe("detected properties of an upload", () => {
  const found = {
    up_axis: { value: "z", reason: "the base is flat in z" },
    unit: { reason: "a height of 70 fits no unit" },
    height_m: 12,
    species: { value: "poplar", reason: "the name" },
    parts: [{ kind: "wood" }, { kind: "wood" }, { kind: "leaves" }],
    warnings: ["The unit is assumed."],
    questions: ["Unsure about 30% of the faces."],
  };

  test("are read from an import report, or from the one inside a build report", () => {
    for (const report of [found, { import: found, meshing: {} }]) {
      const assumed = assumedOf(report);
      expect(assumed.axis.value).toBe("z");
      expect(assumed.warnings).toEqual(["The unit is assumed."]);
      expect(assumed.questions).toEqual(["Unsure about 30% of the faces."]);
    }
  });

  test("say why wood was added, if any was", () => {
    expect(assumedOf(found).addedWood).toBeNull();
    const added_wood = { reason: "the wood ends inside a closed crown", stems_m: [3.1] };
    expect(assumedOf({ import: { ...found, added_wood } }).addedWood).toBe(added_wood.reason);
  });

  test("those of a scanned tree are there only if the file was one", () => {
    expect(assumedOf(found).scan).toBeNull();
    const qsm = { dbh_cm: 18.2, min_radius_mm: 10, dropped: { thin_branches: 3 } };
    expect(assumedOf({ ...found, qsm }).scan).toEqual({ dbh_cm: 18.2, min_radius_mm: 10, dropped: 3, bare: false });
    const wood = found.parts.slice(0, 2);
    const bare = assumedOf({ import: { ...found, parts: wood, qsm: { ...qsm, dbh_cm: null } } }).scan;
    expect(bare).toMatchObject({ dbh_cm: null, bare: true });
  });

  test("an empty or invalid report gives the defaults", () => {
    for (const report of [null, {}, [], "x", { parts: [null] }]) expect(assumedOf(report).axis.value).toBe("y");
  });
});

test("figures of the selected tree", () => {
  const tree = { id: 1, treeId: "maple", species: "maple", position: { x: 0, y: 0, z: 0 }, radius_m: 3, distance_m: 9 };
  const words = figuresInWords({ ...tree, height_m: 10, moves: true, tip_m: 0.5, extrapolationRatio: 1.2, record: 4321 });
  expect(Object.fromEntries(words)).toEqual({
    Height: "10.0 m",
    "Tip displacement": "0.50 m",
    "Relative to height": "5.0 %",
    "Extrapolation ratio": "1.20 (extrapolated)",
    "Current record": "4,321",
  });
  const still = figuresInWords({ ...tree, height_m: 10, moves: false, tip_m: 0, extrapolationRatio: null, record: null });
  expect(still).toEqual([
    ["Height", "10.0 m"],
    ["Motion", "not computed yet"],
  ]);
});
