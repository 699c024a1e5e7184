/** A forest of the package with several workers: its trees move as with one. */
import { readFileSync } from "node:fs";
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import { WorkerClient } from "../../../../web/player/src/three/worker";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import type { WorkerPort } from "../../../../web/player/src/worker/divided/dividedWorker";
import type { FromWorker, ToWorker } from "../../../../web/player/src/worker/simple/messages";
import { answer } from "../../../../web/player/src/worker/simple/serve";
import { Stepper } from "../../../../web/player/src/worker/simple/stepper";
import { severalWorkers } from "../../../../web/player/src/worker/divided/severalWorkers";
import { seededRandom } from "../../seeded";

const [POPLAR, APRICOT] = ["poplar", "apricot"].map((name) => readFileSync(`assets/species/shipped/${name}.table`));

/** A worker in this thread, which answers at once unless it is held. */
class Port implements WorkerPort {
  static all: Port[] = [];
  onmessage: ((event: MessageEvent) => void) | null = null;
  onerror: ((event: ErrorEvent) => void) | null = null;
  ended = false;
  held: FromWorker[] | null = null;
  readonly told: ToWorker[] = [];
  private readonly stepper = new Stepper();

  constructor() {
    Port.all.push(this);
  }

  postMessage(message: ToWorker, transfer: Transferable[] = []): void {
    const data = structuredClone(message, { transfer });
    this.told.push(data);
    answer(this.stepper, data, (reply, buffers) => {
      const copy = structuredClone(reply, { transfer: buffers });
      if (this.held) this.held.push(copy);
      else this.say(copy);
    });
  }

  private say(data: FromWorker): void {
    this.onmessage?.({ data } as MessageEvent);
  }

  release(): void {
    const { held } = this;
    this.held = null;
    for (const message of held ?? []) this.say(message);
  }

  terminate(): void {
    this.ended = true;
  }
}

beforeEach(() => {
  Port.all = [];
  vi.useFakeTimers();
});
afterEach(() => vi.useRealTimers());

function placement(count: number, next: () => number): Float32Array<ArrayBuffer> {
  const place = () => [300 * (next() - 0.5), 300 * (next() - 0.5), 6 * next(), 0.8 + 0.4 * next()];
  return Float32Array.from(Array.from({ length: count }, place).flat());
}

/** A forest of two large groups and a small one. */
async function planted(workers: number, seed: number) {
  const next = seededRandom(seed);
  const client = new WorkerClient(severalWorkers(workers)(() => new Port()));
  client.setWind(PRESETS.breeze);
  const buffer = (file: Buffer) => new Uint8Array(file).buffer;
  const [poplar, apricot] = [await client.load(buffer(POPLAR)), await client.load(buffer(APRICOT))];
  const trees = [placement(730, next), placement(40, next), placement(513, next)];
  const groups = [poplar, apricot, apricot].map(({ table, motion }, g) => client.plant(table, trees[g], motion.stride));
  return { client, groups, trees, apricot, stride: poplar.motion.stride };
}

const bytes = (poses: Float32Array | null) => Buffer.from(poses?.slice().buffer ?? new ArrayBuffer(0));

describe("several workers", () => {
  test.each([2, 3, 4])("%i move every tree as one does: other winds, moved and removed trees, a function (seed 31)", async (count) => {
    const frames: Buffer[][] = [];
    for (const workers of [1, count]) {
      const { client, groups, trees, apricot } = await planted(workers, 31);
      const own: Buffer[] = [];
      const play = (span: number, blow: Parameters<WorkerClient["advance"]>[2] = null) => {
        for (let k = 0; k < span; k++) client.advance(1 / 60, [10 * k, 5], blow);
        expect(client.takeFresh()).toBe(true);
        own.push(...groups.map((group) => bytes(client.poses(group))));
      };
      play(20);
      client.setWind(PRESETS["storm-front"]);
      play(20);
      client.move(groups[2], apricot.table, trees[2].map((value) => value + 1));
      client.remove(groups[1]);
      play(5);
      client.setWind(null);
      play(5, (group, velocity) => velocity.forEach((_, k) => (velocity[k] = 3 + group + Math.sin(k))));
      frames.push(own);
      expect(client.time_s).toBeCloseTo(50 / 60, 9);
    }
    const [one, several] = frames;
    expect(one[0].length).toBeGreaterThan(10_000);
    for (const [k, poses] of one.entries()) expect(several[k].equals(poses), `${k}`).toBe(true);
    expect(one[0].equals(one[3])).toBe(false);
  });

  test("one that is late holds up the others for a short while only, and has the same clock and wind afterwards (seed 32)", async () => {
    const { client, groups, stride } = await planted(2, 32);
    const [first, second] = Port.all;
    for (let frame = 0; frame < 8; frame++) client.advance(1 / 60, [0, 0], null);
    const before = client.poses(groups[0])?.slice();
    second.held = [];
    client.advance(1 / 60, [0, 0], null);
    client.takeFresh();
    vi.advanceTimersToNextTimer();
    expect(client.takeFresh()).toBe(true);
    const moved = (tree: number) => client.poses(groups[0])?.[tree * stride] !== before?.[tree * stride];
    expect([moved(0), moved(32)]).toEqual([true, false]); // blocks of 32 take turns
    client.advance(1 / 60, [0, 0], null); // answered at once, because nothing is asked of the late one
    expect(client.takeFresh()).toBe(true);
    client.setWind(PRESETS["storm-front"]);
    const times = [first, second].map(({ told }) =>
      told.slice(0, told.findLastIndex(({ kind }) => kind === "wind")).reduce((sum, one) => sum + (one.kind === "advance" ? one.dt_s : 0), 0),
    );
    expect(times[1]).toBeCloseTo(times[0], 12);
    second.release();
    client.advance(1 / 60, [0, 0], null);
    expect(client.takeFresh()).toBe(true);
    expect([moved(0), moved(32)]).toEqual([true, true]);
  });

  test("a table that one cannot read fails once; an error of one is that of the forest; all end together", async () => {
    const client = new WorkerClient(severalWorkers(2)(() => new Port()));
    const broken = client.load(new ArrayBuffer(16));
    await expect(broken).rejects.toThrow("table");
    const faults: string[] = [];
    client.failed = (fault) => faults.push(fault);
    Port.all[1].onerror?.({ message: "out of memory" } as ErrorEvent);
    expect(faults).toEqual(["The forest worker is not running: out of memory"]);
    client.dispose();
    expect(Port.all.map(({ ended }) => ended)).toEqual([true, true]);
  });

  test("one is the worker itself; what is no number of workers is refused", () => {
    expect(severalWorkers(1)(() => new Port())).toBe(Port.all[0]);
    for (const count of [0, 1.5, Number.NaN]) expect(() => severalWorkers(count)).toThrow(/count: expected a whole number/);
    for (const [cores, count] of [[2, 1], [4, 2], [16, 4]]) {
      Port.all = [];
      vi.stubGlobal("navigator", { hardwareConcurrency: cores });
      severalWorkers()(() => new Port());
      expect(Port.all.length).toBe(count);
    }
    vi.unstubAllGlobals();
  });
});
