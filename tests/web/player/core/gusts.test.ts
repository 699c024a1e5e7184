import { expect, test } from "vitest";
import { GustLayer } from "../../../../web/player/src/core/modal/gustLayer";
import { fittedModes, decodeTable } from "../../../../web/player/src/core/table/table";
import { CrownGusts } from "../../../../web/player/src/core/wind/crown";
import { compressed, compression } from "../../../../web/player/src/core/wind/pressure";
import type { WindDocument } from "../../../../web/player/src/core/wind/document";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { golden, goldenJson } from "../../golden";

interface Driven {
  frames: number;
  every: number;
  trees: { x_m: number[]; z_m: number[]; yaw_rad: number[]; scale: number[] };
  winds: WindDocument[];
  gusts: number[];
  poses: number[][];
}

const TABLE = decodeTable(golden("pole.safetensors"));
const GOLDEN = goldenJson<Driven>("gusts.json");
const { modes, height_m } = TABLE.metadata;
const FRAME_S = 1 / 30;

const placement = () => {
  const { x_m, z_m, yaw_rad, scale } = GOLDEN.trees;
  return Float32Array.from(x_m.flatMap((x, i) => [x, z_m[i], yaw_rad[i], scale[i]]));
};

function forest(field: WindField, method: "modal" | "paper" = "modal"): LocalMotion {
  const group = { key: "pole", table: TABLE, records: TABLE.paper, placement: placement(), ids: [0, 1, 2], sha256: "", compliance: null };
  return new LocalMotion([group], field, { method, poseEasing: null }, 0);
}

function* play(frames: number, motion: LocalMotion, each: (frame: number) => void) {
  const out = [new Float32Array(3 * Math.ceil((modes + 1) / 4) * 4)];
  for (let frame = 0; frame < frames; frame++) {
    each(frame);
    motion.advance(FRAME_S, out);
    yield out[0];
  }
}

test("gusts within crowns agree with Python to 1e-9", () => {
  const gusts = new CrownGusts(TABLE.metadata.streamlined_exponent);
  gusts.set(new WindField(GOLDEN.winds[0]).at(7.25));
  const { x_m, z_m, yaw_rad, scale } = GOLDEN.trees;
  const yaw = yaw_rad.map(Math.fround);
  const turn = yaw.flatMap((angle) => [Math.cos(angle), Math.sin(angle)]);
  const trees = { x: x_m.map(Math.fround), z: z_m.map(Math.fround), turn, size: scale.map(Math.fround) };
  const places = TABLE.gusts.place.length / 3;
  const found = [0, 9, 40].flatMap((pressure, i) => {
    const out = new Float64Array(2 * places);
    gusts.write(TABLE.gusts.place, trees, i, Math.hypot(pressure, 0.5 * pressure), out);
    return [...out];
  });
  expect(found.length).toBe(GOLDEN.gusts.length);
  for (const [k, value] of found.entries()) expect(value).toBeCloseTo(GOLDEN.gusts[k], 9);
});

test("trees in a changing wind, in and beyond the sampled range, agree with Python to 1e-5 of the height", () => {
  const field = new WindField(GOLDEN.winds[0]);
  const turnAt = GOLDEN.frames / GOLDEN.winds.length;
  const stride = Math.ceil((modes + 1) / 4) * 4;
  const motion = forest(field);
  const change = (frame: number) => {
    if (frame > 0 && frame % turnAt === 0) field.change(GOLDEN.winds[frame / turnAt], frame * FRAME_S);
  };
  let frame = 0;
  for (const poses of play(GOLDEN.frames, motion, change)) {
    frame++;
    if (frame % GOLDEN.every !== 0) continue;
    const expected = GOLDEN.poses[frame / GOLDEN.every - 1];
    for (let tree = 0; tree < 3; tree++) {
      for (let k = 0; k < modes; k++) {
        const gap = Math.abs(poses[tree * stride + k] - expected[tree * modes + k]);
        expect(gap / height_m, `frame ${frame}, tree ${tree}, mode ${k}`).toBeLessThan(1e-5);
      }
    }
  }
});

test("far from the viewer the gusts fade out, and the layer comes to rest", () => {
  const motion = forest(new WindField(GOLDEN.winds[0]));
  const first = fittedModes(TABLE);
  const moves = (poses: Float32Array) => poses.subarray(first, modes).some((value) => value !== 0);
  let last = new Float32Array(0);
  for (const poses of play(60, motion, () => {})) last = poses;
  expect(moves(last)).toBe(true);
  motion.see(1e4, 0);
  for (const poses of play(900, motion, () => {})) last = poses;
  expect(moves(last)).toBe(false);
  motion.see(0, 0);
  for (const poses of play(60, motion, () => {})) last = poses;
  expect(moves(last)).toBe(true);
});

test("a layer that takes over the state of another continues like it", () => {
  const field = new WindField(GOLDEN.winds[0]);
  const one = new GustLayer(TABLE, 2);
  const push = Float32Array.from([30, 30]);
  const calm = Float32Array.from([0, 0]);
  const turn = Float32Array.from([1, 0, 1, 0]);
  const still = Float32Array.from([0, 0]);
  const size = Float32Array.from([1, 1]);
  const trees = { x: Float32Array.from([3, 40]), z: calm, turn, size, phase: still, rate: 1 };
  const q = new Float32Array(2 * modes);
  for (let frame = 0; frame < 40; frame++) one.advance(field.at(frame * FRAME_S), trees, push, calm, null, q);
  const other = new GustLayer(TABLE, 2);
  other.adopt(one, Int32Array.from([0, 1]));
  const [a, b] = [q.slice(), q.slice()];
  one.advance(field.at(2), trees, push, calm, null, a);
  other.advance(field.at(2), trees, push, calm, null, b);
  expect([...b]).toEqual([...a]);
});

test("pressure beyond the sampled range is compressed, and never falls as the wind rises", () => {
  let before = 0;
  for (let ratio = 0; ratio < 30; ratio += 0.01) {
    const now = compressed(ratio);
    if (ratio <= 1) expect(now).toBe(ratio);
    expect(now).toBeGreaterThanOrEqual(before);
    before = now;
  }
  expect(compressed(1.0001) - compressed(0.9999)).toBeCloseTo(2e-4, 6);
  // A wind within the range is not changed, whatever its gusts may be, and one beyond it is scaled as a whole.
  expect(compression(0.7, 0.9)).toBe(1);
  expect(compression(0.5, 3)).toBeCloseTo(compressed(3) / 3, 12);
  expect(compression(6, 3) * 6).toBeCloseTo(compressed(3) * compressed(2), 12);
  expect(compression(2, 0.5) * 2).toBeCloseTo(compressed(2), 12);
});
