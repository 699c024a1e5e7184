/** Trees whose table, records or method change go on moving: no jump, no restart. */
import { describe, expect, test } from "vitest";
import type { Method } from "../../../../web/player/src/core/motion/method";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { decodeTable, type Table } from "../../../../web/player/src/core/table/table";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { JumpBlend } from "../../../../web/player/src/worker/motion/blend";
import { type LocalGroup, LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { ShownPoses } from "../../../../web/player/src/worker/motion/shownPoses";
import { golden } from "../../golden";

const FULL = decodeTable(golden("pole.safetensors"));
const ALONE = decodeTable(golden("pole-table.safetensors"));
const FIRST = decodeTable(golden("pole-linear.safetensors"));
const WIND = {
  version: 1 as const,
  model: "cosine" as const,
  mean_speed_m_s: 7,
  direction_deg: 20,
  gustiness: 0.5,
  convection_speed_m_s: 8,
  seed: 3,
};
const IDS = [1, 2, 3];
const PLACEMENT = Float32Array.from(IDS.flatMap((id) => [7 * id, 3 * id, id, 0.8 + 0.1 * id]));
const FRAME_S = 1 / 60;

const groupOf = (table: Table, records = table.paper): LocalGroup => ({
  key: "ash",
  table,
  records,
  ids: IDS,
  placement: PLACEMENT,
  sha256: "",
  compliance: null,
});

/** The worker's loop: a source of poses, its blend, and what is displayed. */
class Player {
  motion: LocalMotion | null = null;
  private group = groupOf(FIRST);
  private method: Method = "modal";
  private readonly field = new WindField(WIND);
  private readonly blend = new JumpBlend();
  private readonly shown = new ShownPoses();

  plan(group: LocalGroup, method: Method): void {
    const starts = this.shown.continueAs([group]);
    const next = new LocalMotion([group], this.field, { method, poseEasing: null }, this.motion?.time_s ?? 0);
    if (this.method === "modal") next.startAt(starts);
    this.method = method;
    if (this.motion) next.adopt(this.motion);
    this.motion = next;
    this.group = group;
    this.blend.start(starts);
    this.advance(0);
  }

  advance(dt_s = FRAME_S): void {
    this.shown.begin(dt_s);
    const { buffers } = this.shown;
    this.motion?.advance(dt_s, buffers);
    this.blend.apply(buffers, dt_s);
  }

  /** Displacement (m) of the topmost node of every tree. */
  tips(): number[] {
    const { nodeRest, nodeBasis, metadata } = this.group.table;
    const heights = Array.from({ length: nodeRest.length / 3 }, (_, n) => nodeRest[3 * n + 1]);
    const tip = heights.indexOf(Math.max(...heights));
    const stride = poseStride(metadata.modes);
    return IDS.flatMap((_, tree) =>
      [0, 1, 2].map((axis) => {
        let sum = 0;
        for (let k = 0; k < metadata.modes; k++) {
          sum += nodeBasis[(3 * tip + axis) * metadata.modes + k] * this.shown.buffers[0][tree * stride + k];
        }
        return sum;
      }),
    );
  }

  /** Largest change of a tip's displacement from frame to frame, and largest displacement. */
  play(frames: number): { fastest: number; farthest: number } {
    let [fastest, farthest] = [0, 0];
    let before = this.tips();
    for (let frame = 0; frame < frames; frame++) {
      this.advance();
      const now = this.tips();
      fastest = Math.max(fastest, ...now.map((value, i) => Math.abs(value - before[i])));
      farthest = Math.max(farthest, ...now.map(Math.abs));
      before = now;
    }
    return { fastest, farthest };
  }
}

function warm(group: LocalGroup, method: Method): Player {
  const player = new Player();
  player.plan(group, method);
  player.play(600);
  return player;
}

const changes: [string, LocalGroup, Method, LocalGroup, Method][] = [
  ["a first table to the full one, with more modes", groupOf(FIRST), "modal", groupOf(ALONE), "modal"],
  ["a full table to one with fewer modes", groupOf(ALONE), "modal", groupOf(FIRST), "modal"],
  ["records that arrive", groupOf(ALONE, null), "paper", groupOf(ALONE, FULL.paper), "paper"],
  ["the paper's method to the modal one", groupOf(FULL), "paper", groupOf(FULL), "modal"],
];

describe("the displayed trees do not jump", () => {
  test.each(changes)("%s", (_, from, before, to, after) => {
    const player = warm(from, before);
    const usual = player.play(300);
    const old = player.tips();
    player.plan(to, after);
    player.tips().forEach((tip, i) => expect(Math.abs(tip - old[i])).toBeLessThan(0.02 * usual.farthest));
    const across = player.play(90);
    expect(usual.farthest).toBeGreaterThan(0.05);
    // The two methods differ by a good part of the sway, which the transition covers in three seconds.
    expect(across.fastest).toBeLessThan(2.5 * usual.fastest);
  });

  test("a full table takes over the sway of the first one", () => {
    const [changed, steady] = [warm(groupOf(FIRST), "modal"), warm(groupOf(ALONE), "modal")];
    changed.plan(groupOf(ALONE), "modal");
    let [worst, farthest] = [0, 0];
    for (let frame = 0; frame < 240; frame++) {
      changed.advance();
      steady.advance();
      const expected = steady.tips();
      farthest = Math.max(farthest, ...expected.map(Math.abs));
      changed.tips().forEach((tip, i) => {
        worst = Math.max(worst, Math.abs(tip - expected[i]));
      });
    }
    expect(worst).toBeLessThan(0.1 * farthest);
  });

  test("in still air trees at rest stay exactly at rest", () => {
    const still = new Player();
    (still as unknown as { field: WindField }).field = new WindField({ ...WIND, mean_speed_m_s: 0 });
    still.plan(groupOf(FIRST), "modal");
    still.play(30);
    still.plan(groupOf(ALONE), "modal");
    expect(still.play(60).farthest).toBe(0);
  });
});

test("without records the paper's method moves trees by the modal one", () => {
  const [wanted, modal] = [warm(groupOf(ALONE, null), "paper"), warm(groupOf(ALONE), "modal")];
  expect(wanted.tips()).toEqual(modal.tips());
  expect(wanted.motion?.inspect({ group: 0, tree: 0 })?.record).toBeNull();
  expect(warm(groupOf(FULL), "paper").motion?.inspect({ group: 0, tree: 0 })?.record).toBeGreaterThanOrEqual(0);
});
