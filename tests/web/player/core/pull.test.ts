import { describe, expect, test } from "vitest";
import { decodeCompliance } from "../../../../web/player/src/core/pull/compliance";
import { solveFactor } from "../../../../web/player/src/core/pull/factor";
import { DragConstraint, type Vector } from "../../../../web/player/src/core/pull/dragConstraint";
import { PullError, pointResponse } from "../../../../web/player/src/core/pull/pointResponse";
import { restFrequency, ringShare } from "../../../../web/player/src/core/pull/restRing";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { PointResponses } from "../../../../web/player/src/worker/motion/pulls/pointResponses";
import { RestRings } from "../../../../web/player/src/worker/motion/pulls/restRings";
import { pullInWords } from "../../../../web/src/page/pulling/pullTag";
import { golden, goldenJson } from "../../golden";

interface Golden {
  responses: {
    vertex: number;
    oscillators: number[];
    pose: number[];
    compliance: number[];
    of_modes: number[];
    limit_n: number;
    reach_m: number;
  }[];
  hand: {
    vertex: number;
    dt_s: number;
    targets_m: Vector[];
    swayed_m: Vector[];
    forces_n: number[][];
    e: number[];
    v: number[];
  };
}

const said = goldenJson<Golden>("pull.json");
const table = decodeTable(golden("pole-table.safetensors"));
const file = golden("pole-compliance.safetensors");
const compliance = decodeCompliance(file);
const RELATIVE = 1e-6;

function near(found: ArrayLike<number>, wanted: ArrayLike<number>): void {
  expect(found.length).toBe(wanted.length);
  const size = Math.max(...Array.from(wanted, Math.abs), 1e-300);
  for (let k = 0; k < wanted.length; k++) expect(Math.abs(found[k] - wanted[k])).toBeLessThan(RELATIVE * size);
}

describe("the response of a point, as Python computes it", () => {
  for (const one of said.responses) {
    test(`vertex ${one.vertex}`, () => {
      const whole = pointResponse(table, one.vertex, compliance);
      near(whole.oscillators, one.oscillators);
      near(whole.pose, one.pose);
      near(whole.compliance, one.compliance);
      near([whole.limit_N, whole.reach_m], [one.limit_n, one.reach_m]);
      near(pointResponse(table, one.vertex, null).compliance, one.of_modes);
    });
  }

  test("modes and the rest together are the whole response, at the pulled vertex", () => {
    const { vertex } = said.responses[1];
    const { compliance: whole, point, pose, rest } = pointResponse(table, vertex, compliance);
    const r = table.metadata.modes;
    const sums = Array.from({ length: 9 }, (_, at) => {
      const [i, j] = [Math.floor(at / 3), at % 3];
      let sum = rest!.field[9 * vertex + 3 * j + i];
      for (let k = 0; k < r; k++) sum += point[i * r + k] * pose[3 * k + j];
      return sum;
    });
    near(sums, whole);
  });

  test("a vertex that does not exist, and a file of another mesh", () => {
    expect(() => pointResponse(table, table.vertexNode.length, compliance)).toThrow(PullError);
    const other = { ...compliance, meshSha256: "0" };
    expect(pointResponse(table, 0, other).rest).toBeNull();
  });
});

test("the factor solves L Lᵀ u = f", () => {
  const { free, pointer, rows, blocks } = compliance;
  const size = 3 * free;
  // L as a full matrix: the diagonal blocks are stored as their inverses.
  const lower = new Float64Array(size * size);
  for (let k = 0; k < free; k++) {
    const [a, b, c, d, e, f] = blocks.subarray(9 * pointer[k], 9 * pointer[k] + 6);
    const [p, q, r] = [1 / a, 1 / c, 1 / f];
    const diagonal = [p, 0, 0, -b * p * q, q, 0, (b * e * q - d) * p * r, -e * q * r, r];
    for (let i = 0; i < 9; i++) lower[(3 * k + Math.floor(i / 3)) * size + 3 * k + (i % 3)] = diagonal[i];
    for (let s = pointer[k] + 1; s < pointer[k + 1]; s++)
      for (let i = 0; i < 9; i++)
        lower[(3 * rows[s] + Math.floor(i / 3)) * size + 3 * k + (i % 3)] = blocks[9 * s + i];
  }
  const force = Float64Array.from({ length: size }, (_, k) => Math.sin(1 + k));
  const u = force.slice();
  solveFactor(compliance, u);
  const half = Array.from({ length: size }, (_, j) => u.reduce((sum, x, i) => sum + lower[i * size + j] * x, 0));
  const back = Array.from({ length: size }, (_, i) => half.reduce((sum, x, j) => sum + lower[i * size + j] * x, 0));
  near(back, force);
});

test("the hand follows its target with the forces of Python's", () => {
  const { vertex, dt_s, targets_m, swayed_m, forces_n, e, v } = said.hand;
  const hand = new DragConstraint(pointResponse(table, vertex, compliance));
  targets_m.forEach((target, k) => {
    hand.step(dt_s, target, swayed_m[k]);
    near(hand.force_N, forces_n[k]);
  });
  near(hand.released.e, e);
  near(hand.released.v, v);
});

describe("damaged compliance files are refused", () => {
  const bytes = new Uint8Array(file);
  test("cut off", () => expect(() => decodeCompliance(bytes.slice(0, -4))).toThrow(/truncated/));
  test("a table", () => expect(() => decodeCompliance(golden("pole-table.safetensors"))).toThrow(/not a galewood-compl/));
  test("other bytes in the tensors", () => {
    let refused = 0;
    for (let at = bytes.length - 1200; at < bytes.length; at += 40) {
      const damaged = bytes.slice();
      damaged.fill(255, at, at + 4);
      try {
        decodeCompliance(damaged);
      } catch {
        refused++;
      }
    }
    expect(refused).toBeGreaterThan(10);
  });
});

describe("a pulled tree", () => {
  const STILL = {
    version: 1 as const,
    model: "cosine" as const,
    mean_speed_m_s: 0,
    direction_deg: 0,
    gustiness: 0,
    convection_speed_m_s: 8,
    seed: 1,
  };
  const { modes } = table.metadata;
  const stride = poseStride(modes);
  const vertex = said.responses[2].vertex;
  const node = table.vertexNode[vertex];

  function moved(poses: Float32Array, tree: number): number {
    const shown = [0, 1, 2].map((axis) => {
      let sum = 0;
      for (let k = 0; k < modes; k++) sum += table.nodeBasis[(3 * node + axis) * modes + k] * poses[tree * stride + k];
      return sum;
    });
    return Math.hypot(...shown);
  }

  for (const method of ["modal", "paper"] as const) {
    test(`follows the hand, returns after the release, and leaves its neighbour alone (${method})`, () => {
      const responses = new PointResponses();
      const group = {
        key: "pole",
        sha256: "pole",
        compliance: null,
        table,
        records: decodeTable(golden("pole.safetensors")).paper,
        ids: [1, 2],
        placement: Float32Array.from([0, 0, 0, 1, 9, 0, 1, 1.2]),
      };
      const motion = new LocalMotion([group], new WindField(STILL), { method, poseEasing: null }, 0, responses);
      const out = [new Float32Array(2 * stride)];
      const target_m: Vector = [0.05 * table.metadata.height_m, 0, 0];
      motion.pull({ hand: 1, at: { group: 0, tree: 0 }, vertex, target_m });
      for (let k = 0; k < 30; k++) motion.advance(1 / 30, out);
      const held_m = moved(out[0], 0);
      expect(held_m).toBeGreaterThan(0.9 * target_m[0]);
      expect(moved(out[0], 1)).toBe(0);
      motion.release(1);
      motion.advance(1 / 60, out);
      // continuous: the tree starts where it was held
      expect(Math.abs(moved(out[0], 0) - held_m)).toBeLessThan(0.25 * held_m);
      let latest_m = 0;
      for (let k = 0; k < 30 * 60; k++) {
        motion.advance(1 / 30, out);
        if (k > 30 * 57) latest_m = Math.max(latest_m, moved(out[0], 0));
      }
      expect(latest_m).toBeLessThan(0.1 * held_m);
    });
  }
});

test("what the modes do not show rings down at its own frequency", () => {
  const rest = {
    field: new Float32Array(9),
    yields: Float64Array.from([4, 0, 0, 0, 4, 0, 0, 0, 4]),
    inertia: Float64Array.from([0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01]),
  };
  const omega = restFrequency(rest, [3, 0, 0]);
  expect(omega).toBeCloseTo(20, 9);
  expect(ringShare(omega, 0)).toBe(1);
  expect(ringShare(omega, Math.PI / omega)).toBeLessThan(-0.7);
  expect(ringShare(omega, 10)).toBeNull();
  const rings = new RestRings();
  const response = { ...pointResponse(table, 0, null), rest };
  const order = { hand: 5, at: { group: 0, tree: 0 }, vertex: 0, target_m: [0, 0, 0] as const };
  const pulled = { order, table: "pole", response, force_N: [3, 0, 0] };
  expect(rings.advance([pulled], 0.02)).toMatchObject([{ held: true, force_N: [3, 0, 0] }]);
  expect(rings.advance([], 0.02)).toMatchObject([{ held: false }]);
  expect(rings.advance([], 20)).toEqual([]);
});

test("displacement and force in words", () => {
  expect(pullInWords(0.234, 88.4)).toBe("23 cm · 88 N");
  expect(pullInWords(1.239, 1240)).toBe("1.24 m · 1.2 kN");
});
