/** Trees that stay in a new plan: when a species is added, or a table replaces another one. */
import { describe, expect, test } from "vitest";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { decodeTable, type Table } from "../../../../web/player/src/core/table/table";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { carryGroup, poseTransfer, rowsBefore } from "../../../../web/player/src/worker/motion/carry";
import { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { groupRows } from "../../../../web/player/src/core/table/nodeLevels";
import { tableMotion } from "../../../../web/player/src/worker/table/tableMotion";
import { NODE_LEVEL_COUNT } from "../../../../web/player/src/trees/detail";
import { golden } from "../../golden";
import { seededRandom } from "../../seeded";

const table = decodeTable(golden("pole.safetensors"));
const WIND = {
  version: 1 as const,
  model: "cosine" as const,
  mean_speed_m_s: 8,
  direction_deg: 20,
  gustiness: 0.6,
  convection_speed_m_s: 8,
  seed: 3,
};

function groupOf(ids: number[], of: Table = table) {
  const placement = Float32Array.from(ids.flatMap((id) => [7 * id, 3 * (id % 5), id, 0.8 + 0.05 * (id % 7)]));
  const own = { key: "ash", table: of, records: of.paper, sha256: "", compliance: null };
  return { ...own, ids: Uint32Array.from(ids), placement };
}

const bufferFor = (count: number) => new Float32Array(count * poseStride(table.metadata.modes));

describe("an added species", () => {
  for (const method of ["modal", "paper"] as const) {
    test(`does not restart the existing trees (${method})`, () => {
      const before = groupOf([1, 2, 3, 4, 5, 6]);
      const after = groupOf([6, 2, 9, 4]);
      const options = { method, poseEasing: null };
      const first = new LocalMotion([before], new WindField(WIND), options, 0);
      const alone = new LocalMotion([before], new WindField(WIND), options, 0);
      const rows = [bufferFor(6), bufferFor(6)];
      for (let frame = 0; frame < 90; frame++) {
        first.advance(1 / 60, [rows[0]]);
        alone.advance(1 / 60, [rows[1]]);
      }
      const next = new LocalMotion([after], new WindField(WIND), options, first.time_s);
      next.adopt(first);
      const out = bufferFor(4);
      for (let frame = 0; frame < 60; frame++) {
        next.advance(1 / 60, [out]);
        alone.advance(1 / 60, [rows[1]]);
        const stride = poseStride(table.metadata.modes);
        for (const [row, old] of [[0, 5], [1, 1], [3, 3]]) {
          expect(out.slice(row * stride, (row + 1) * stride)).toEqual(rows[1].slice(old * stride, (old + 1) * stride));
        }
      }
    });
  }
});

test("previous rows: the index of each tree, or −1", () => {
  expect([...rowsBefore([4, 8, 15], [15, 16, 4])]).toEqual([2, -1, 0]);
});

describe("a table that replaces another of the same mesh", () => {
  /** The same tree with mixed and doubled coordinates, which can represent every motion of the old one. */
  function mixed(): Table {
    const { modes } = table.metadata;
    const nodeBasis = table.nodeBasis.slice();
    for (let row = 0; row < nodeBasis.length / modes; row++) {
      const old = table.nodeBasis.subarray(row * modes, (row + 1) * modes);
      for (let k = 0; k < modes; k++) nodeBasis[row * modes + k] = 2 * old[k] + (k > 0 ? old[k - 1] : 0);
    }
    return { ...table, nodeBasis };
  }

  test("keeps the shape of the tree", () => {
    const full = mixed();
    const { modes } = table.metadata;
    const stride = poseStride(modes);
    const random = seededRandom(2);
    const shown = Float32Array.from({ length: 2 * stride }, (_, i) => (i % stride < modes ? random() - 0.5 : 7));
    const carried = carryGroup(groupOf([3, 1], full), [groupOf([1, 2])], [shown]);
    expect([...(carried?.known ?? [])]).toEqual([0, 1]);
    let [error, size] = [0, 0];
    for (const node of new Set(table.vertexNode)) {
      for (let axis = 0; axis < 3; axis++) {
        let [was, is] = [0, 0];
        for (let k = 0; k < modes; k++) {
          was += table.nodeBasis[(node * 3 + axis) * modes + k] * shown[k];
          is += full.nodeBasis[(node * 3 + axis) * modes + k] * (carried?.poses[stride + k] ?? 0);
        }
        error = Math.max(error, Math.abs(was - is));
        size = Math.max(size, Math.abs(was));
      }
    }
    expect(error / size).toBeLessThan(0.02);
    expect(carried?.poses[stride + modes]).toBe(7);
  });

  test("a first table of 16 natural modes passes its pose on to a full one of 20", () => {
    const random = seededRandom(7);
    const nodes = 60;
    const rowsOf = (modes: number, all: Float32Array) =>
      Float32Array.from({ length: nodes * 3 * modes }, (_, i) => all[Math.floor(i / modes) * 20 + (i % modes)]);
    const all = Float32Array.from({ length: nodes * 3 * 20 }, () => random() - 0.5);
    const vertexJoint = Uint16Array.from({ length: 900 }, (_, vertex) => vertex % nodes);
    const jointNodes = Uint16Array.from({ length: 2 * nodes }, (_, k) => k >> 1);
    const jointShare = new Float32Array(nodes);
    const made = (modes: number) =>
      ({ ...table, vertexJoint, jointNodes, jointShare, nodeBasis: rowsOf(modes, all), metadata: { ...table.metadata, modes } }) as Table;
    const pose = Float32Array.from({ length: poseStride(16) }, (_, k) => (k < 16 ? random() - 0.5 : k === 16 ? 7 : 0));
    const carried = carryGroup(groupOf([1], made(20)), [groupOf([1], made(16))], [pose]);
    expect(carried?.poses.length).toBe(poseStride(20));
    carried?.poses.forEach((value, k) => {
      expect(value).toBeCloseTo(k < 16 ? pose[k] : k === 20 ? 7 : 0, 5);
    });
  });

  test("a table of another mesh does not take over any pose", () => {
    const other = { ...table, vertexJoint: table.vertexJoint.slice(1) };
    expect(poseTransfer(table, other)).toBeNull();
    expect(carryGroup(groupOf([1], other), [groupOf([1])], [bufferFor(1)])).toBeNull();
    expect(carryGroup({ ...groupOf([1]), key: "oak" }, [groupOf([1])], [bufferFor(1)])).toBeNull();
  });
});

describe("nodes of the levels of detail", () => {
  test("groups get finer, each row belongs to the nearest centre, and the error decreases", () => {
    const random = seededRandom(4);
    const rows = Float32Array.from({ length: 300 * 4 }, () => random());
    const [few, more] = groupRows(rows, 4, [5, 40]);
    const spread = (of: Uint16Array) => {
      const groups = Math.max(...of) + 1;
      const mean = new Float64Array(groups * 4);
      const size = new Float64Array(groups);
      of.forEach((g, row) => {
        size[g]++;
        for (let k = 0; k < 4; k++) mean[g * 4 + k] += rows[row * 4 + k];
      });
      return of.reduce((sum, g, row) => {
        for (let k = 0; k < 4; k++) sum += (rows[row * 4 + k] - mean[g * 4 + k] / size[g]) ** 2;
        return sum;
      }, 0);
    };
    expect(Math.max(...few)).toBe(4);
    expect(Math.max(...more)).toBe(39);
    expect(spread(more)).toBeLessThan(0.5 * spread(few));
  });

  test("equal rows need no further groups", () => {
    expect([...groupRows(Float32Array.of(1, 1, 2, 2, 1, 1), 2, [2, 9])[1]]).toEqual([0, 1, 0]);
  });

  test("every level covers all nodes, and its quads hold the modes and the wind", () => {
    const motion = tableMotion("", table, 0);
    expect(motion.levels).toHaveLength(NODE_LEVEL_COUNT);
    for (const level of motion.levels) {
      expect(level.of.length).toBe(motion.nodes);
      expect(Math.max(...level.of, ...level.bend)).toBe(level.nodes - 1);
      expect(level.coordinates.length).toBe(Math.min(motion.modes, 4 * level.quads - 1));
      expect(level.basis.length).toBe(level.nodes * 12 * level.quads);
    }
    expect(motion.reach_m).toBeGreaterThan(0);
    expect(motion.reach_m).toBeLessThan(table.metadata.height_m);
  });
});
