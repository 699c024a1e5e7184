import { expect, test } from "vitest";
import { compileKernel } from "../../../../web/scripts/compileKernel";
import { decodeTable, type Table } from "../../../../web/player/src/core/table/table";
import { ModalForest } from "../../../../web/player/src/core/modal/modalForest";
import { FIRST_BYTE, ModalKernel } from "../../../../web/player/src/core/modal/modalKernel";
import { PlaceGusts } from "../../../../web/player/src/core/modal/placeGusts";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { CALM_BREEZE } from "../../../../web/player/src/core/wind/presets";
import { MODAL_KERNEL } from "../../../../web/player/src/core/modal/modalKernel.wasm";
import { contracts, forceTerms, poseTerms } from "../../../../web/player/src/core/modal/modalTensors";
import { sumsOf } from "../../../../web/player/src/core/modal/termSums";
import { golden } from "../../golden";
import { seededRandom } from "../../seeded";

const POLE = decodeTable(golden("pole.safetensors"));

test("the committed kernel equals its compiled source", { timeout: 60_000 }, async () => {
  expect(Buffer.from(await compileKernel()).toString("hex"), "run: npm run kernel").toBe(MODAL_KERNEL);
});

test("the kernel's constants end before its data", () => {
  const module = new WebAssembly.Module(Buffer.from(MODAL_KERNEL, "hex"));
  const memory = new WebAssembly.Memory({ initial: 1 });
  const { constantsEnd } = new WebAssembly.Instance(module, { env: { memory } }).exports;
  expect((constantsEnd as WebAssembly.Global).value).toBeLessThanOrEqual(FIRST_BYTE);
});

/** Numbers of oscillators, coupled coordinates, modes, drag points, and places of the crown. */
type Sizes = readonly [d: number, c: number, r: number, m: number, places: number];

/** A table of these sizes, with a polynomial force much weaker than the springs. */
function madeUp([d, c, r, m, places]: Sizes, next: () => number): Table {
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
    dragPlace: Float32Array.from({ length: m * places }, () => (2 * next()) / places),
    place: some(3 * places, 6),
    placeLoad: some(2 * d * places, 0.1 / Math.sqrt(places)),
    streamlinedExponent: 1 + next(),
  };
  return { ...POLE, modal, metadata: { ...POLE.metadata, modes: r } };
}

const SIZES: Sizes[] = [
  [24, 4, 30, 12, 16],
  [16, 4, 24, 4, 0],
  [48, 12, 60, 8, 32],
  [5, 3, 5, 1, 1],
  [17, 2, 26, 5, 7],
  [8, 0, 9, 0, 3],
  [8, 0, 9, 0, 0],
  [16, 0, 16, 3, 6],
  [20, 6, 20, 12, 5],
];
const TITLE = "%i oscillators, %i coupled, %i modes, %i drag points, %i places: agrees with the TypeScript implementation";

/** A table whose force moves the oscillators in few ways only, as that of an individual, with a sparse pose. */
function withFewWays(table: Table, ways: number, next: () => number): Table {
  const { modal } = table;
  const d = modal.step.length / 6;
  const along = Float64Array.from({ length: ways * d }, () => 2 * next() - 1);
  const shares = Float64Array.from({ length: (ways * modal.force.length) / d }, () => (0.05 * (2 * next() - 1)) / Math.max(1, ways));
  const force = modal.force.map((_, at) => {
    let sum = 0;
    for (let way = 0; way < ways; way++) sum += shares[Math.floor(at / d) * ways + way] * along[way * d + (at % d)];
    return sum;
  });
  const width = modal.pose.length / poseTerms(d, (modal.limits.length - 3) / 2);
  const pose = modal.pose.map((value, at) => (at >= (d + 2) * width && at < (d + 5) * width ? value : 0));
  return { ...table, modal: { ...modal, force, pose } };
}

test.each(SIZES)(TITLE, (...sizes) => {
  const next = seededRandom(sizes[0]);
  expectAgreement(madeUp(sizes, next), next);
});

test.each([0, 1, 2, 4, 5])("a force in %i ways and a sparse pose: agrees with the TypeScript implementation", (ways) => {
  const next = seededRandom(20 + ways);
  const table = withFewWays(madeUp([24, 2, 27, 12, 32], next), ways, next);
  expect(sumsOf(table.modal.force, 24)?.count).toBe(ways > 4 ? undefined : ways);
  expectAgreement(table, next);
});

test("forests of many tables, more than one memory holds, move as each does in TypeScript", () => {
  const next = seededRandom(11);
  const forests = Array.from({ length: 240 }, (_, k) => {
    const table = madeUp(SIZES[k % 3], next);
    const few = k % 2 ? withFewWays(table, 2, next) : table;
    const gusts = new PlaceGusts(few.modal, 1);
    return { gusts, both: [new ModalForest(few, 1), new ModalForest(few, 1, true)] };
  });
  const field = new WindField({ ...CALM_BREEZE, gustiness: 0.8 });
  for (let frame = 0; frame < 40; frame++) {
    const moment = field.at(frame / 30);
    for (const { gusts, both } of forests) {
      gusts.set(moment);
      for (const forest of both) forest.advance(1 / 30, [20], [-10], gusts);
    }
  }
  for (const { both } of forests) both[1].q.forEach((q, k) => expect(both[0].q[k]).toBeCloseTo(q, 5));
  expect(forests.every(({ both }) => both[0].q.some((q) => Math.abs(q) > 1e-3))).toBe(true);
});

test("a memory is shared by small forests, and a large one has its own", () => {
  const table = madeUp([24, 0, 27, 12, 32], seededRandom(12));
  const bufferOf = (count: number) => {
    const { modal, metadata } = table;
    return ModalKernel.make([{ modal, modes: metadata.modes, dt_s: metadata.dt_s }], count)?.states.buffer;
  };
  const [first, second, large] = [bufferOf(1), bufferOf(1), bufferOf(20_000)];
  const more = Array.from({ length: 400 }, () => bufferOf(1));
  expect(second).toBe(first);
  expect(large).not.toBe(first);
  expect(new Set(more).size).toBeGreaterThan(1);
  expect(new Set(more).size).toBeLessThan(6);
});

/** Compares kernel and TypeScript in a wind that comes and goes. */
function expectAgreement(table: Table, next: () => number): void {
  expect(contracts(table.modal.step)).toBe(true);
  const count = 5;
  const forests = [new ModalForest(table, count), new ModalForest(table, count, true)];
  expect(forests.map(({ compiled }) => compiled)).toEqual([true, false]);
  const scale = Float32Array.from({ length: count }, () => 0.6 + next());
  for (const forest of forests) forest.setTrees(scale, scale, scale, scale);
  const field = new WindField({ ...CALM_BREEZE, gustiness: 0.8 });
  const gusts = new PlaceGusts(table.modal, count);
  gusts.share[2] = 0;
  let largest = 0;
  for (let frame = 0; frame < 2000; frame++) {
    gusts.set(field.at(frame / 30));
    const strength = frame < 1500 ? 30 : 0;
    const px = scale.map((s) => strength * Math.cos(0.11 * frame * s));
    const pz = scale.map((s) => strength * Math.sin(0.07 * frame + s));
    for (const forest of forests) forest.advance(1 / 30, px, pz, frame % 500 < 400 ? gusts : null);
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
}

test("a forest continues from the state of another one of the same table", () => {
  const table = madeUp([17, 2, 26, 4, 6], seededRandom(5));
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
  const table = madeUp([16, 2, 21, 3, 0], seededRandom(6));
  const before = new ModalForest(table, 2, true);
  for (let frame = 0; frame < 60; frame++) before.advance(1 / 30, [20, 10], [20, 10]);
  const after = new ModalForest(table, 2);
  after.adopt(before, Int32Array.of(0, 1));
  after.advance(1 / 30, [0, 0], [0, 0]);
  expect(after.q.every((q) => q === 0)).toBe(true);
});
