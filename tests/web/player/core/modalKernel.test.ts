import { expect, test } from "vitest";
import { compileKernel } from "../../../../web/scripts/compileKernel";
import { decodeTable, type Table } from "../../../../web/player/src/core/table/table";
import { ModalForest } from "../../../../web/player/src/core/modal/modalForest";
import { MODAL_KERNEL } from "../../../../web/player/src/core/modal/modalKernel.wasm";
import { contracts, forceTerms, poseTerms } from "../../../../web/player/src/core/modal/modalTensors";
import { golden } from "../../golden";
import { seededRandom } from "../../seeded";
import { NO_GUSTS } from "../../tableFile";

const POLE = decodeTable(golden("pole.safetensors"));

test("the committed kernel equals its compiled source", { timeout: 60_000 }, async () => {
  expect(Buffer.from(await compileKernel()).toString("hex"), "run: npm run kernel").toBe(MODAL_KERNEL);
});

/** A table of d oscillators, c coupled coordinates and r modes, with a polynomial force much weaker than the springs. */
function madeUp(d: number, c: number, r: number, m: number, next: () => number): Table {
  const some = (length: number, size: number) => Float32Array.from({ length }, () => size * (2 * next() - 1));
  const step = new Float32Array(6 * d);
  for (let k = 0; k < d; k++) {
    // Implicit Euler step of x″ + 2ζω x′ + ω² x = f.
    const omega = 2 + 3 * k;
    const dt = POLE.metadata.dt_s;
    const gain = 1 / (1 + 0.2 * omega * dt + (omega * dt) ** 2);
    const r10 = -gain * omega * omega * dt;
    const r11 = gain - 1;
    step.set([dt * r10, dt * gain, r10, r11, dt * dt * gain, dt * gain], 6 * k);
  }
  const limits = Float32Array.from({ length: 3 + 2 * c }, () => 0.5 + next());
  limits[2] = 30;
  const sway = new Float32Array(2 * d);
  sway[0] = 1;
  sway[d + 1] = 1;
  const modal = {
    step,
    sway,
    limits,
    load: some(2 * d, 0.1),
    force: some(forceTerms(c) * d, 0.05),
    shown: some(d, 1),
    pose: some(poseTerms(d, c) * (r - d), 0.05),
    dragPoint: Float32Array.from({ length: 2 * m }, (_, at) => (at % 2 ? 1 : 3) * next()),
    dragShape: some(3 * m * d, 0.2),
    dragRest: Float32Array.from({ length: d }, () => 0.05 * next()),
    streamlinedExponent: 1 + next(),
  };
  return { ...POLE, modal, gusts: NO_GUSTS, metadata: { ...POLE.metadata, modes: r } };
}

const SIZES = [
  [16, 4, 24, 4],
  [48, 12, 60, 8],
  [5, 3, 5, 1],
  [17, 2, 26, 5],
  [8, 0, 9, 0],
  [16, 0, 16, 3],
  [20, 6, 20, 12],
] as const;
const TITLE = "%i oscillators, %i coupled, %i modes, %i drag points: agrees with the TypeScript implementation";

test.each(SIZES)(TITLE, (d, c, r, m) => {
  const next = seededRandom(d);
  const table = madeUp(d, c, r, m, next);
  expect(contracts(table.modal.step)).toBe(true);
  const count = 5;
  const forests = [new ModalForest(table, count), new ModalForest(table, count, true)];
  expect(forests.map(({ compiled }) => compiled)).toEqual([true, false]);
  const scale = Float32Array.from({ length: count }, () => 0.6 + next());
  for (const forest of forests) forest.setTrees(scale, scale, scale, scale);
  let largest = 0;
  for (let frame = 0; frame < 2000; frame++) {
    const strength = frame < 1500 ? 30 : 0;
    const px = scale.map((s) => strength * Math.cos(0.11 * frame * s));
    const pz = scale.map((s) => strength * Math.sin(0.07 * frame + s));
    for (const forest of forests) forest.advance(1 / 30, px, pz);
    const [kernel, plain] = forests;
    plain.q.forEach((q, k) => {
      largest = Math.max(largest, Math.abs(q));
      if (!(Math.abs(q - kernel.q[k]) <= 1e-5)) expect(kernel.q[k], `frame ${frame}, ${k}`).toBeCloseTo(q, 5);
    });
    plain.extrapolationRatio.forEach((share, k) => {
      if (!(Math.abs(share - kernel.extrapolationRatio[k]) <= 1e-5)) expect(kernel.extrapolationRatio[k]).toBeCloseTo(share, 5);
    });
  }
  expect(largest).toBeGreaterThan(0.1);
});

test("a forest continues from the state of another one of the same table", () => {
  const table = madeUp(17, 2, 26, 4, seededRandom(5));
  const before = new ModalForest(table, 3);
  const wind = [20, 10, 5];
  for (let frame = 0; frame < 60; frame++) before.advance(1 / 30, wind, wind);
  const after = new ModalForest(table, 2);
  after.adopt(before, Int32Array.of(2, -1));
  const poses = (forest: ModalForest, tree: number) => [...forest.q.subarray(26 * tree, 26 * (tree + 1))];
  for (let frame = 0; frame < 10; frame++) {
    before.advance(1 / 30, wind, wind);
    after.advance(1 / 30, [5, 5], [5, 5]);
    expect(poses(after, 0)).toEqual(poses(before, 2));
  }
  expect(poses(after, 1)).not.toEqual(poses(before, 2));
});

test("trees start at rest if the state layout of the previous forest differs", () => {
  const table = madeUp(16, 2, 21, 3, seededRandom(6));
  const before = new ModalForest(table, 2, true);
  for (let frame = 0; frame < 60; frame++) before.advance(1 / 30, [20, 10], [20, 10]);
  const after = new ModalForest(table, 2);
  after.adopt(before, Int32Array.of(0, 1));
  after.advance(1 / 30, [0, 0], [0, 0]);
  expect(after.q.every((q) => q === 0)).toBe(true);
});
