/** What the workers of a divided forest are told, and when. */
import { beforeEach, describe, expect, test } from "vitest";
import type { PosePacket } from "../../../../web/player/src/core/motion/posePacket";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { steady } from "../../../../web/player/src/core/wind/transition";
import { ForestWorkers, type FromWorkers, type PlanOrder } from "../../../../web/player/src/worker/divided/forestWorkers";
import {
  isDivisible,
  MOST_WORKERS,
  sharesOf,
  treeIn,
  treeOf,
  TREES_PER_WORKER,
  workersFor,
} from "../../../../web/player/src/worker/divided/shares";
import type { FromWorker, GroupPlan, TableMotion, ToWorker } from "../../../../web/player/src/worker/protocol";
import { seededRandom } from "../../seeded";

function group(key: string, count: number, next: () => number): GroupPlan {
  const placement = Float32Array.from({ length: 4 * count }, () => 1000 * next());
  const ids = Uint32Array.from({ length: count }, () => 1e6 * next());
  return { key, table: key, leafTable: key, placement, ids, recorded: false, compliance: null, rows: null };
}

describe("shares", () => {
  test.each([1, 2, 3, 4])("of %i workers have every tree once, with its place and id (seed 11)", (count) => {
    const next = seededRandom(11);
    const groups = [0, 1, 40, 511, 512, 3000].map((trees, g) => group(`kind ${g}`, trees, next));
    const shares = sharesOf(groups, count);
    const seen = groups.map(({ ids }) => new Uint8Array(ids.length));
    for (const share of shares) {
      for (const [own, { ids, placement, key }] of share.groups.entries()) {
        for (let tree = 0; tree < ids.length; tree++) {
          const at = treeOf(share, { group: own, tree });
          seen[at.group][at.tree]++;
          const whole = groups[at.group];
          expect([key, ids[tree], ...placement.subarray(4 * tree, 4 * tree + 4)]).toEqual([
            whole.key,
            whole.ids[at.tree],
            ...whole.placement.subarray(4 * at.tree, 4 * at.tree + 4),
          ]);
          if (tree % 97 === 0) expect(treeIn(share, at)).toEqual({ group: own, tree });
          if (tree % 97 === 0) expect(shares.filter((other) => treeIn(other, at)).length).toBe(1);
        }
      }
    }
    for (const trees of seen) expect(trees.every((times) => times === 1)).toBe(true);
    // Small groups stay together, and large ones are divided evenly.
    for (const { parts } of shares)
      for (const { group: g, rows } of parts)
        if (count > 1) expect(rows ? Math.abs(rows.length * count - groups[g].ids.length) : 0).toBeLessThan(400);
    expect(shares.flatMap(({ parts }) => parts.filter(({ group: g }) => g === 2)).length).toBe(1);
  });

  test("a tree keeps its worker when others come and go (seed 12)", () => {
    const next = seededRandom(12);
    const before = group("oak", 2000, next);
    const after = { ...before, ids: before.ids.slice(600), placement: before.placement.slice(2400) };
    const [old, now] = [before, after].map((one) => sharesOf([one], 3).map(({ groups: [{ ids }] }) => new Set(ids)));
    for (const id of after.ids) expect(now.findIndex((ids) => ids.has(id))).toBe(old.findIndex((ids) => ids.has(id)));
  });

  test("there are as many as trees and cores ask for", () => {
    expect([0, 1, 2, 3].map((cores) => workersFor(1e6, cores))).toEqual([1, 1, 1, 1]);
    expect([4, 5, 6, 8, 64].map((cores) => workersFor(1e6, cores))).toEqual([2, 2, 3, 4, MOST_WORKERS]);
    const trees = [0, 1, 2, 3, 5].map((share) => share * TREES_PER_WORKER);
    expect(trees.map((count) => workersFor(count, 16))).toEqual([1, 2, 3, 4, 4]);
    expect(workersFor(TREES_PER_WORKER - 1, 16)).toBe(1);
  });

  test("streams, shared forests and the paper's method stay whole", () => {
    const plan = { lookup: "worker", method: "modal", share: null } as const;
    expect(isDivisible(plan)).toBe(true);
    expect(isDivisible({ ...plan, lookup: "server" })).toBe(false);
    expect(isDivisible({ ...plan, method: "paper" })).toBe(false);
    expect(isDivisible({ ...plan, share: { id: "meadow", replant: false, about: {} } })).toBe(false);
  });
});

/** A worker that answers when the test says so. */
class Scripted {
  static all: Scripted[] = [];
  onmessage: ((event: { data: FromWorker }) => void) | null = null;
  onerror: ((event: { message: string }) => void) | null = null;
  told: ToWorker[] = [];
  ended = false;
  time_s = 0;

  constructor() {
    Scripted.all.push(this);
  }

  postMessage(message: ToWorker): void {
    this.told.push(message);
    if (message.kind === "advance") this.time_s += message.dt_s;
    if (message.kind === "plan" && this.time_s === 0) this.time_s = message.plan.from_s;
  }

  terminate(): void {
    this.ended = true;
  }

  say(data: FromWorker): void {
    this.onmessage?.({ data });
  }

  table(sha256: string): void {
    this.say({ kind: "table", motion: { sha256 } as TableMotion });
  }

  /** Answers the last request. */
  pose(ratio = 0): void {
    const { plan } = this.last("plan");
    const groups = plan.groups.map(() => ({ near: 0, all: false, far: [], periods: [] }));
    const [rows, near, leading, far] = [new Float32Array(1), new Uint32Array(1), new Int16Array(1), new Uint32Array(1)];
    const packet: PosePacket = { groups, rows, near, leading, far };
    this.say({
      kind: "poses",
      epoch: plan.epoch,
      time_s: this.time_s,
      work: { wind_ms: 1, lookup_ms: ratio, total_ms: 1 + ratio },
      packet,
      connection: { state: "idle", latency_ms: null, frameAge_ms: null, kB_s: 0 },
      wind: { state: steady(PRESETS.breeze), coverage: ratio },
      extrapolationRatio: ratio,
      watched: null,
      pulled: [],
    });
  }

  of<Kind extends ToWorker["kind"]>(kind: Kind): Extract<ToWorker, { kind: Kind }>[] {
    return this.told.filter((one): one is Extract<ToWorker, { kind: Kind }> => one.kind === kind);
  }

  last<Kind extends ToWorker["kind"]>(kind: Kind): Extract<ToWorker, { kind: Kind }> {
    const all = this.of(kind);
    return all[all.length - 1];
  }
}

const FRAME_S = 1 / 60;
const VIEWER = [0, 0] as const;

describe("the workers", () => {
  let heard: FromWorkers[];
  let workers: ForestWorkers;
  const poses = () => heard.filter((one): one is Extract<FromWorkers, { kind: "poses" }> => one.kind === "poses");
  const groups = [group("oak", 1000, seededRandom(13))];
  const order = (workers: number | null, lookup: "worker" | "server" = "worker"): PlanOrder => ({
    plan: { groups, lookup, from_s: 5, method: "modal", poseEasing: null, share: null },
    wind: PRESETS.breeze,
    socketUrl: "ws://none",
    workers,
  });
  const running = () => Scripted.all.filter(({ ended }) => !ended).length;
  const advance = (dt_s = FRAME_S) => workers.advance(dt_s, VIEWER);

  beforeEach(() => {
    heard = [];
    Scripted.all = [];
    workers = new ForestWorkers(
      () => new Scripted() as unknown as Worker,
      2,
      () => [],
      (message) => heard.push(message),
    );
    workers.send({ kind: "load", sha256: "oak", url: "/oak" });
    Scripted.all[0].table("oak");
  });

  /** Two workers that have a plan. */
  function two(): readonly [Scripted, Scripted] {
    workers.plan(order(2));
    const [first, second] = Scripted.all;
    first.pose();
    second.table("oak");
    second.pose();
    expect(poses().map(({ planned, packets }) => [planned, packets.length])).toEqual([[true, 2]]);
    heard = [];
    for (const one of [first, second]) one.told = one.of("plan");
    return [first, second];
  }

  test("a new one loads its tables, then gets clock and wind of the first one; messages wait for it, the page for both", () => {
    workers.plan(order(2));
    const [first, second] = Scripted.all;
    expect(second.told).toEqual([{ kind: "load", sha256: "oak", url: "/oak" }]);
    workers.send({ kind: "gust", x_m: 1, z_m: 2 });
    second.table("oak");
    expect(heard.map(({ kind }) => kind)).toEqual(["table"]); // that of the first one
    expect(second.of("plan")).toEqual([]);
    advance();
    first.pose();
    expect([poses().length, workers.isBusy]).toEqual([0, true]);
    const { plan, wind } = second.last("plan");
    expect([plan.from_s, wind]).toEqual([first.time_s, steady(PRESETS.breeze)]);
    expect([first, second].map((one) => one.told.map(({ kind }) => kind).slice(-2))).toEqual([["plan", "gust"], ["plan", "gust"]]);
    second.pose();
    expect(workers.isBusy).toBe(false);
    advance();
    expect([first, second].map((one) => one.last("advance").dt_s)).toEqual([2 * FRAME_S, 2 * FRAME_S]);
  });

  test("one that is late holds up no other, and takes one longer step afterwards", () => {
    const [first, second] = two();
    advance();
    for (let frame = 0; frame < 5; frame++) {
      first.pose();
      advance();
    }
    expect(poses().map(({ packets }) => packets.length)).toEqual([1, 1, 1, 1, 1]);
    expect([first, second].map((one) => one.of("advance").length)).toEqual([6, 1]);
    second.pose();
    first.pose();
    advance();
    expect(second.last("advance").dt_s).toBeCloseTo(6 * FRAME_S, 9);
    expect(second.time_s).toBeCloseTo(first.time_s, 9);
    expect(second.last("advance").spare).not.toBeNull();
  });

  test("one that is later than a quarter of a second holds the clock of all", () => {
    const [first, second] = two();
    for (let frame = 0; frame < 60; frame++) {
      advance();
      first.pose();
    }
    second.pose();
    advance();
    expect(second.time_s).toBeCloseTo(first.time_s, 9);
    expect(second.last("advance").dt_s).toBeCloseTo(0.25, 9);
  });

  test("wind and gusts begin for one that is late when they do for the others", () => {
    const [first, second] = two();
    advance();
    first.pose();
    advance();
    first.pose();
    workers.send({ kind: "gust", x_m: 1, z_m: 2 });
    expect(second.told.map(({ kind }) => kind)).toEqual(["plan", "advance", "advance", "gust"]);
    expect(second.time_s).toBeCloseTo(first.time_s, 9);
    second.pose();
    expect(workers.isBusy).toBe(true);
    second.pose();
    expect(workers.isBusy).toBe(false);
  });

  test("figures are those of all", () => {
    const [first, second] = two();
    advance();
    first.pose(0.25);
    second.pose(0.75);
    const last = poses()[1];
    const [one, other] = [first, second].map((worker) => worker.last("plan").plan.groups[0].ids.length);
    expect(last.extrapolationRatio).toBe(0.75);
    expect(last.work.total_ms).toBe(1.75);
    expect(last.wind.coverage).toBeCloseTo((0.25 * one + 0.75 * other) / 1000, 9);
  });

  test("a pull is sent to the worker of its tree, named by its place there", () => {
    const [first, second] = two();
    const tree = groups[0].ids.findIndex((id) => id % 2 === 1);
    const pull = { hand: 1, at: { group: 0, tree }, vertex: 3, target_m: [0, 0, 0] } as const;
    workers.send({ kind: "pull", order: pull });
    expect(first.of("pull")).toEqual([]);
    expect(second.of("pull")).toEqual([{ kind: "pull", order: { ...pull, at: { group: 0, tree: 0 } } }]);
    workers.send({ kind: "watch", at: { group: 0, tree } });
    expect([first, second].map((one) => one.last("watch").at)).toEqual([null, { group: 0, tree: 0 }]);
  });

  test("a stream needs one only, and the others end", () => {
    const [first, second] = two();
    workers.plan(order(2, "server"));
    expect([second.ended, first.last("plan").plan.groups]).toEqual([true, groups]);
    first.pose();
    expect(poses().map(({ packets }) => packets.length)).toEqual([1]);
  });

  test("one that ends leaves its trees to the other; answers to the plan before are dropped", () => {
    const [first, second] = two();
    advance();
    first.onerror?.({ message: "out of memory" });
    expect([first.ended, running()]).toEqual([true, 1]);
    expect(second.last("plan").plan.groups).toEqual(groups);
    const { epoch } = second.last("plan").plan;
    expect(epoch).toBe(second.of("plan")[0].plan.epoch + 1);
    second.pose();
    expect(poses().map(({ planned }) => planned)).toEqual([true]);
  });

  test("where none runs, the page is told why", () => {
    workers.plan(order(1));
    for (let k = 0; k < 4; k++) {
      Scripted.all[Scripted.all.length - 1].onerror?.({ message: "" });
    }
    expect(Scripted.all.every(({ ended }) => ended)).toBe(true);
    const last = heard[heard.length - 1];
    expect(last).toMatchObject({ kind: "problem", title: "The trees have stopped moving" });
    advance();
    workers.plan(order(1));
    workers.send({ kind: "wind", wind: PRESETS.breeze });
    expect(Scripted.all.length).toBe(4);
  });

  test("a table that a new worker cannot load leaves the forest to the others", () => {
    workers.plan(order(2));
    const [first, second] = Scripted.all;
    first.pose();
    second.say({ kind: "tableFailed", sha256: "oak", title: "no such file" });
    expect([second.ended, running()]).toEqual([true, 1]);
    first.pose();
    expect(poses().map(({ packets }) => packets.length)).toEqual([1]);
  });
});
