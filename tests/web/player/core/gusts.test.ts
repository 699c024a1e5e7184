import { expect, test } from "vitest";
import { ModalForest } from "../../../../web/player/src/core/modal/modalForest";
import { PlaceGusts } from "../../../../web/player/src/core/modal/placeGusts";
import { GroupWind } from "../../../../web/player/src/core/motion/groupWind";
import { JointWind } from "../../../../web/player/src/core/motion/jointWind";
import { decodeTable } from "../../../../web/player/src/core/table/table";
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
const { modes, height_m, streamlined_exponent } = TABLE.metadata;
const STRIDE = Math.ceil((modes + 1) / 4) * 4;
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
  const out = [new Float32Array(3 * STRIDE)];
  for (let frame = 0; frame < frames; frame++) {
    each(frame);
    motion.advance(FRAME_S, out);
    yield out[0];
  }
}

test("gusts within crowns agree with Python to 1e-9", () => {
  const gusts = new CrownGusts();
  gusts.set(new WindField(GOLDEN.winds[0]).at(7.25));
  const { x_m, z_m, yaw_rad, scale } = GOLDEN.trees;
  const yaw = yaw_rad.map(Math.fround);
  const turn = yaw.flatMap((angle, i) => [Math.cos(angle), Math.sin(angle), Math.fround(scale[i])]);
  const trees = { x: x_m.map(Math.fround), z: z_m.map(Math.fround), turn };
  const places = TABLE.modal.place.length / 3;
  const found = [0, 9, 40].flatMap((pressure, i) => {
    const out = new Float64Array(2 * places);
    gusts.write(TABLE.modal.place, streamlined_exponent, trees, i, Math.hypot(pressure, 0.5 * pressure), out);
    return [...out];
  });
  expect(found.length).toBe(GOLDEN.gusts.length);
  for (const [k, value] of found.entries()) expect(value).toBeCloseTo(GOLDEN.gusts[k], 9);
});

test("trees in a changing wind, in and beyond the sampled range, agree with Python to 1e-5 of the height", () => {
  const field = new WindField(GOLDEN.winds[0]);
  const turnAt = GOLDEN.frames / GOLDEN.winds.length;
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
        const gap = Math.abs(poses[tree * STRIDE + k] - expected[tree * modes + k]);
        expect(gap / height_m, `frame ${frame}, tree ${tree}, mode ${k}`).toBeLessThan(1e-5);
      }
    }
  }
});

test("far from the viewer trees feel the same wind everywhere in their crowns; the gusts fade out on the way", () => {
  const [near, between, far] = [0, 65, 100].map((far_m) => {
    const field = new WindField(GOLDEN.winds[0]);
    const motion = forest(field);
    let last = new Float32Array(0);
    for (const poses of play(120, motion, () => motion.see([far_m, 0]))) last = poses;
    return last;
  });
  const field = new WindField(GOLDEN.winds[0]);
  const wind = new GroupWind(placement(), height_m, TABLE.modal.limits[2], streamlined_exponent);
  const calm = new ModalForest(TABLE, 3);
  calm.setTrees(wind.x, wind.z, wind.column(2), wind.column(3));
  for (let frame = 0, time_s = 0; frame < 120; frame++) {
    time_s += FRAME_S;
    new JointWind([wind]).update(field, field.at(time_s));
    calm.advance(FRAME_S, wind.pressureX, wind.pressureZ);
  }
  const gap = (poses: Float32Array) => Math.hypot(...calm.q.map((q, k) => q - poses[STRIDE * Math.floor(k / modes) + (k % modes)]));
  expect(gap(far)).toBe(0);
  expect(gap(between)).toBeGreaterThan(1e-4);
  expect(gap(near)).toBeGreaterThan(1.2 * gap(between));
});

test("the pressures of the gusts are along and across that at the tree, in its frame, and fade with its share", () => {
  const gusts = new PlaceGusts(TABLE.modal, 1);
  const places = TABLE.modal.place.length / 3;
  gusts.set(new WindField(GOLDEN.winds[0]).at(7.25));
  const tree = { x: [3], z: [4], turn: [Math.cos(0.7), Math.sin(0.7), 1.2] };
  const relative = new Float64Array(2 * places);
  const direct = new CrownGusts();
  direct.set(new WindField(GOLDEN.winds[0]).at(7.25));
  direct.write(TABLE.modal.place, streamlined_exponent, tree, 0, 50, relative);
  const out = new Float64Array(2 * places);
  expect(gusts.write(tree, 0, 30, -40, out)).toBe(true);
  for (let g = 0; g < places; g++) {
    expect(out[g]).toBeCloseTo(30 * relative[2 * g] + 40 * relative[2 * g + 1], 9);
    expect(out[places + g]).toBeCloseTo(-40 * relative[2 * g] + 30 * relative[2 * g + 1], 9);
  }
  const half = new Float64Array(2 * places);
  gusts.share[0] = 0.5;
  gusts.write(tree, 0, 30, -40, half);
  half.forEach((value, k) => expect(value).toBeCloseTo(out[k] / 2, 9));
  expect(gusts.write(tree, 0, 0, 0, out)).toBe(false);
  gusts.share[0] = 0;
  expect(gusts.write(tree, 0, 30, -40, out)).toBe(false);
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
