/** A forest whose trees are divided among workers: each moves as in a single one. */
import { readFileSync } from "node:fs";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { EasedPoses } from "../../../../web/player/src/core/motion/easedPoses";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { FAR_COORDINATES, leadingCoordinates } from "../../../../web/player/src/core/table/leadingCoordinates";
import { decodeTable, type Table } from "../../../../web/player/src/core/table/table";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { ForestWorkers, type FromWorkers } from "../../../../web/player/src/worker/divided/forestWorkers";
import type { GroupPlan, ShownTrees } from "../../../../web/player/src/worker/protocol";
import { seededRandom } from "../../seeded";
import { ModuleWorker } from "./moduleWorker";

const NAMES = ["poplar", "maple-forest", "apricot"];
const FILES = NAMES.map((name) => readFileSync(`assets/species/shipped/${name}.table`));
const TABLES = FILES.map((file) => decodeTable(file));
/** The last group is too small to be divided. */
const COUNTS = [700, 550, 60];
const FRAME_S = 1 / 60;
const PLAN = { lookup: "worker", from_s: 3, method: "modal", poseEasing: null, share: null } as const;

const easedOf = ({ metadata, modal }: Table, count: number) =>
  new EasedPoses(count, metadata.modes, leadingCoordinates(metadata.modes, modal.step.length / 6, FAR_COORDINATES));

function groupsOf(seed: number): GroupPlan[] {
  const next = seededRandom(seed);
  return NAMES.map((key, g) => {
    const places = Array.from({ length: COUNTS[g] }, () => {
      const [away_m, angle] = [700 * Math.sqrt(next()), 2 * Math.PI * next()];
      return [away_m * Math.cos(angle), away_m * Math.sin(angle), 6 * next(), 0.8 + 0.4 * next()];
    });
    const ids = Uint32Array.from(places, () => 1e6 * next());
    const placement = Float32Array.from(places.flat());
    return { key, table: key, leafTable: key, placement, ids, recorded: false, compliance: null, rows: null };
  });
}

type Poses = Extract<FromWorkers, { kind: "poses" }>;

/** What the page does with the workers. */
class Page {
  eased: readonly EasedPoses[] = [];
  poses: Poses | null = null;
  readonly started: ModuleWorker[] = [];
  readonly problems: string[] = [];
  readonly workers: ForestWorkers;
  private groups: readonly GroupPlan[] = [];
  /** Whether poses have arrived since the last frame. */
  private fresh = false;

  constructor() {
    const start = () => {
      const worker = new ModuleWorker();
      this.started.push(worker);
      return worker as unknown as Worker;
    };
    const shown = (): ShownTrees[] =>
      this.eased.length === 0 ? [] : this.groups.map((group, g) => ({ ...group, poses: this.eased[g].poses }));
    this.workers = new ForestWorkers(start, 2, shown, (message) => this.receive(message));
    this.workers.send({ kind: "wind", wind: PRESETS.breeze });
    for (const name of NAMES) this.workers.send({ kind: "load", sha256: name, url: name });
  }

  private receive(message: FromWorkers): void {
    if (message.kind === "problem" || message.kind === "tableFailed") this.problems.push(message.title);
    if (message.kind !== "poses") return;
    this.poses = message;
    if (message.planned) this.eased = this.groups.map(({ ids, key }) => easedOf(TABLES[NAMES.indexOf(key)], ids.length));
    if (!this.fresh) for (const eased of this.eased) eased.begin();
    this.fresh = true;
    for (const { packet, parts } of message.packets) {
      const at = { row: 0, near: 0, far: 0 };
      for (const [part, { group, rows }] of parts.entries()) this.eased[group].take(packet, part, at, rows);
    }
  }

  async plan(groups: readonly GroupPlan[], workers: number): Promise<void> {
    const plan = { ...PLAN, groups };
    this.workers.plan({ plan, wind: PRESETS.breeze, socketUrl: "ws://none", workers });
    const before = this.groups;
    await this.settled(() => {
      if (this.groups === before) this.groups = groups;
    });
  }

  /** Waits until all workers have answered. */
  async settled(meanwhile = () => {}): Promise<void> {
    meanwhile();
    while (this.workers.isBusy && this.problems.length === 0) await new Promise((done) => setTimeout(done));
    expect(this.problems).toEqual([]);
  }

  async play(frames: number, x: number): Promise<void> {
    for (let frame = 0; frame < frames; frame++) {
      this.fresh = false;
      this.workers.advance(FRAME_S, [x + 0.2 * frame, 0]);
      await this.settled();
    }
  }

  /** Number of workers. */
  get running(): number {
    return this.started.filter(({ ended }) => !ended).length;
  }

  /** All poses as they are displayed: distant trees on the way to their newest ones. */
  get all(): Float32Array[] {
    return this.eased.map((eased, g) => {
      const { modes } = TABLES[g].metadata;
      const stride = poseStride(modes);
      const shown = eased.poses.slice();
      const every = Uint16Array.from({ length: modes }, (_, k) => k);
      const ease = eased.easer(every);
      for (let tree = 0; tree * stride < shown.length; tree++) ease(tree, shown, tree * stride);
      return shown;
    });
  }
}

let pages: Page[] = [];
const opened = () => {
  const page = new Page();
  pages.push(page);
  return page;
};

beforeEach(() => {
  vi.stubGlobal("fetch", async (url: string) => new Response(new Uint8Array(FILES[NAMES.indexOf(url)])));
});
afterEach(() => {
  for (const { workers } of pages) workers.dispose();
  pages = [];
  vi.unstubAllGlobals();
});

/** Largest difference between the coordinates of two pages' trees, m. */
function apart_m(a: readonly Float32Array[], b: readonly Float32Array[]): number {
  let most_m = 0;
  for (const [g, poses] of a.entries()) {
    const { modes } = TABLES[g].metadata;
    const stride = poseStride(modes);
    for (let k = 0; k < poses.length; k++)
      if (k % stride < modes) most_m = Math.max(most_m, Math.abs(poses[k] - b[g][k]));
  }
  return most_m;
}

test.each([2, 3])("%i workers move every tree exactly as one does, in changing winds, gusts and plans (seed 5)", async (count) => {
  const groups = groupsOf(5);
  const fewer = groups.map((group, g) => ({
    ...group,
    ids: group.ids.slice(0, COUNTS[g] - 30),
    placement: group.placement.slice(0, 4 * (COUNTS[g] - 30)),
  }));
  const played: Float32Array[][] = [];
  for (const workers of [1, count]) {
    const page = opened();
    await page.plan(groups, workers);
    expect(page.running).toBe(workers);
    played.push(page.all);
    await page.play(40, -100);
    page.workers.send({ kind: "wind", wind: PRESETS["storm-front"] });
    page.workers.send({ kind: "gust", x_m: -80, z_m: 20 });
    await page.play(40, 60);
    played.push(page.all);
    await page.plan(fewer, workers);
    page.workers.send({ kind: "watch", at: { group: 0, tree: 7 } });
    await page.play(20, 0);
    expect(page.poses?.watched).not.toBeNull();
    played.push(page.all);
  }
  const [one, divided] = [played.slice(0, 3), played.slice(3)];
  for (const [k, poses] of one.entries()) {
    for (const [g, group] of poses.entries()) expect(Buffer.from(group.buffer).equals(Buffer.from(divided[k][g].buffer))).toBe(true);
  }
  expect(apart_m(one[0], one[1])).toBeGreaterThan(0.1);
}, 60_000);

test("a pulled tree of the second worker moves as in a single one, and is named by its place in the forest (seed 6)", async () => {
  const groups = groupsOf(6);
  const tree = groups[1].ids.findIndex((id) => id % 2 === 1);
  const results: { pulled: unknown; poses: Float32Array[] }[] = [];
  for (const workers of [1, 2]) {
    const page = opened();
    await page.plan(groups, workers);
    const order = { hand: 1, at: { group: 1, tree }, vertex: 4000, target_m: [0.5, 0, 0.2] as const };
    page.workers.send({ kind: "pull", order });
    await page.play(20, 0);
    expect(page.poses?.pulled.map(({ at }) => at)).toEqual([{ group: 1, tree }]);
    page.workers.send({ kind: "release", hand: 1 });
    const pulled = page.poses?.pulled;
    await page.play(5, 0);
    expect(page.poses?.pulled.filter(({ held }) => held)).toEqual([]);
    results.push({ pulled, poses: page.all });
    if (workers === 2) expect(page.started[1].told.filter(({ kind }) => kind === "pull").length).toBe(1);
  }
  const [one, two] = results;
  expect(two.pulled).toEqual(one.pulled);
  expect(apart_m(one.poses, two.poses)).toBe(0);
}, 60_000);

test("trees go on from where they are when workers are added, end by themselves or are no longer wanted (seed 7)", async () => {
  const groups = groupsOf(7);
  const page = opened();
  const single = opened();
  for (const one of [page, single]) await one.plan(groups, 1);
  const jumps: number[] = [];
  /** The largest difference over one frame. */
  const jump = async (act: () => Promise<void>) => {
    const before = page.all;
    await act();
    jumps.push(apart_m(before, page.all));
  };
  await page.play(40, 0);
  await jump(() => page.plan(groups, 1)); // distant trees are then where they were on the way to
  await page.play(10, 0);
  await jump(() => page.plan(groups, 3));
  expect(page.running).toBe(3);
  await page.play(10, 0);
  await jump(async () => {
    page.started[1].crash("out of memory");
    await page.settled();
  });
  expect([page.running, page.started[1].ended]).toEqual([2, true]);
  await page.play(10, 0);
  await jump(async () => {
    page.started[0].crash("out of memory"); // the first one
    await page.settled();
  });
  expect(page.running).toBe(1);
  await page.play(10, 0);
  await jump(async () => {
    page.started[2].crash("out of memory"); // the only one
    await page.settled();
  });
  expect([page.running, page.started.length]).toEqual([1, 4]);
  const [usual, ...others] = jumps;
  console.log(`largest change at a new plan ${usual} m, at a change of workers ${others.join(", ")} m`);
  for (const change of others) expect(change).toBeLessThan(1.5 * usual);
  await page.play(10, 0);
  await single.play(90, 0);
  // the same clock and wind
  expect(page.poses?.time_s).toBeCloseTo(single.poses?.time_s ?? 0, 6);
  expect(page.poses?.wind.state).toEqual(single.poses?.wind.state);
}, 60_000);
