/** Shared forests that are too large for the server: their clients play them, in one wind under one clock. */
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import { MOST_STREAMED_TREES } from "../../../../web/player/src/core/constants";
import { EasedPoses } from "../../../../web/player/src/core/motion/easedPoses";
import { packPoses } from "../../../../web/player/src/core/motion/posePacket";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import { FAR_COORDINATES, leadingCoordinates } from "../../../../web/player/src/core/table/leadingCoordinates";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { type WindState, withFront } from "../../../../web/player/src/core/wind/transition";
import { decodeRequest, encodeReply, encodeRequest, type Reply, type Request } from "../../../../web/player/src/core/wire/wire";
import { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { SharedMotion } from "../../../../web/player/src/worker/motion/sharedMotion";
import { forestRequest, type PlannedGroup } from "../../../../web/player/src/worker/stream/forestRequest";
import { golden } from "../../golden";
import { seededRandom } from "../../seeded";

const TABLE = decodeTable(golden("pole.safetensors"));
const MESSAGE_BYTES = 4 * 1024 * 1024;
const SHARE = { id: "meadow", replant: true, about: { planting: "trees=100000&forest=7" } };

const groupsOf = (count: number): PlannedGroup[] =>
  ["a", "b"].map((letter) => ({ table: letter.repeat(64), placement: new Float32Array(4 * (count / 2)).fill(1) }));

describe("the request for a shared forest", () => {
  const field = new WindField(PRESETS.breeze);
  const asked = (mode: "stream" | "table", count: number) =>
    forestRequest(mode, groupsOf(count), field, 0, { method: "modal", poseEasing: null, share: SHARE });

  test("names the places of its trees only as long as a server may step them", () => {
    const largest = asked("table", MOST_STREAMED_TREES);
    expect(largest.trees.length).toBe(4 * MOST_STREAMED_TREES);
    const beyond = asked("table", MOST_STREAMED_TREES + 2);
    expect(beyond.trees.length).toBe(0);
    expect(beyond.groups.map(({ count }) => count)).toEqual([MOST_STREAMED_TREES / 2 + 1, MOST_STREAMED_TREES / 2 + 1]);
  });

  test("fits into a message, however many trees it has", () => {
    expect(encodeRequest(asked("table", 1_000_000)).byteLength).toBeLessThan(1000);
    expect(encodeRequest(asked("table", MOST_STREAMED_TREES)).byteLength).toBeLessThan(MESSAGE_BYTES);
    expect(encodeRequest(asked("stream", 100_000)).byteLength).toBeLessThan(MESSAGE_BYTES);
  });
});

/** Without gusts, so that the one of a front is seen. */
const STEADY = { ...PRESETS.breeze, mean_speed_m_s: 6, direction_deg: 0, gustiness: 0 };

/** A server with one shared forest, which passes on hands and gusts and steps nothing. Its clock is ahead. */
class Server {
  private state: WindState = new WindField(STEADY).state;
  private readonly lines: Line[] = [];

  get made_s(): number {
    return 1e6 + performance.now() / 1000;
  }

  get time_s(): number {
    return 500 + performance.now() / 1000;
  }

  tellClock(): void {
    this.tell(this.clock());
  }

  private clock(): Reply {
    return { type: "clock", time_s: this.time_s, made_s: this.made_s, paused: false };
  }

  private tell(reply: Reply): void {
    for (const line of this.lines) line.tell(reply);
  }

  private wind(): Reply {
    return { type: "windState", state: { ...this.state } };
  }

  hear(line: Line, request: Request): void {
    if (request.type === "ping") line.tell({ type: "pong", t: request.t, server_s: this.made_s });
    else if (request.type === "forest") {
      this.lines.push(line);
      line.tell(this.wind());
      line.tell(this.clock());
    } else if (request.type === "gust") {
      this.state = withFront(this.state, request.x, request.z, this.time_s);
      this.tell(this.wind());
    } else if (request.type === "pull") {
      const { type: _, ...pull } = request;
      this.tell({ type: "pulls", time_s: this.time_s, pulls: [{ ...pull, force: [0, 0, 0] }] });
    } else if (request.type === "release") this.tell({ type: "pulls", time_s: this.time_s, pulls: [] });
  }
}

let server: Server;
let delay_ms = () => 0;

/** A connection with random delays, which keep the order of the messages. */
class Line {
  static readonly CONNECTING = 0;
  static readonly OPEN = 1;
  readyState = Line.CONNECTING;
  onopen: (() => void) | null = null;
  onmessage: ((event: unknown) => void) | null = null;
  private readonly arrives_ms = { up: 0, down: 0 };

  constructor(readonly url: string) {
    this.deliver("down", () => {
      this.readyState = Line.OPEN;
      this.onopen?.();
    });
  }

  private deliver(way: "up" | "down", act: () => void): void {
    const now_ms = performance.now();
    this.arrives_ms[way] = Math.max(this.arrives_ms[way], now_ms + delay_ms());
    setTimeout(act, this.arrives_ms[way] - now_ms);
  }

  send(data: Uint8Array<ArrayBuffer>): void {
    this.deliver("up", () => server.hear(this, decodeRequest(data.slice().buffer)));
  }

  tell(reply: Reply): void {
    this.deliver("down", () => this.onmessage?.({ data: encodeReply(reply).slice().buffer }));
  }

  close(): void {
    this.readyState = 3;
  }
}

const TREES = 300;
const FRAME_MS = 16;
const { modes } = TABLE.metadata;
const STRIDE = poseStride(modes);

/** Trees up to 500 m apart, of which each visitor is near to others. */
function placementOf(next: () => number): Float32Array<ArrayBuffer> {
  const place = () => [360 * (next() - 0.5), 360 * (next() - 0.5), 6 * next(), 0.8 + 0.4 * next()];
  return Float32Array.from(Array.from({ length: TREES }, place).flat());
}

class Visitor {
  readonly field = new WindField(PRESETS["storm-front"]);
  readonly motion: SharedMotion;
  readonly poses = [new Float32Array(TREES * STRIDE)];
  /** What is displayed of these. */
  private readonly eased = new EasedPoses(TREES, modes, leadingCoordinates(modes, TABLE.modal.step.length / 6, FAR_COORDINATES));
  /** When each tree felt the gust first, on the server's clock, s. */
  readonly felt_s = new Float64Array(TREES).fill(Number.NaN);
  private readonly x_m: Float64Array;
  private readonly z_m: Float64Array;
  private readonly speed = [new Float64Array(TREES), new Float64Array(TREES)];

  /** `time_s`: of the visitor's own forest, before it joins. */
  constructor(placement: Float32Array<ArrayBuffer>, time_s: number, [x, z]: readonly [number, number]) {
    const trees = Array.from({ length: TREES }, (_, tree) => placement.subarray(4 * tree));
    this.x_m = Float64Array.from(trees, ([at]) => at);
    this.z_m = Float64Array.from(trees, ([, at]) => at);
    const ids = Uint32Array.from({ length: TREES }, (_, id) => id);
    const group = { key: "ash", table: TABLE, records: null, sha256: "", compliance: null, ids, placement };
    const local = new LocalMotion([group], this.field, { method: "modal", poseEasing: null }, time_s);
    const plan = { method: "modal", poseEasing: null, share: SHARE } as const;
    const planned = [{ table: "a".repeat(64), placement }];
    this.motion = new SharedMotion(local, this.field, {
      url: "ws://here",
      placements: [placement],
      request: () => forestRequest("table", planned, this.field, local.time_s, plan),
      onReply: () => {},
      problem: (title) => expect.unreachable(title),
    });
    this.motion.see([x, z]);
  }

  advance(): void {
    const { field, motion, x_m, z_m, felt_s } = this;
    const [x, z] = this.speed;
    motion.advance(FRAME_MS / 1000, this.poses);
    this.eased.begin();
    const group = { poses: this.poses[0], stride: STRIDE, modes, changed: motion.changed[0] ?? null };
    this.eased.take(packPoses([group], null), 0, { row: 0, near: 0, far: 0 });
    field.velocity(x_m, z_m, field.at(motion.time_s), x, z);
    for (let tree = 0; tree < TREES; tree++)
      if (Number.isNaN(felt_s[tree]) && Math.hypot(x[tree], z[tree]) > 1.1 * STEADY.mean_speed_m_s) felt_s[tree] = server.made_s;
  }

  /** The first coordinate of every tree as it is displayed. */
  get sway(): number[] {
    const { eased } = this;
    return Array.from({ length: TREES }, (_, tree) => {
      const shown = eased.poses.slice(tree * STRIDE, tree * STRIDE + 1);
      eased.easer(Uint16Array.of(0))(tree, shown, 0);
      return shown[0];
    });
  }
}

const rms = (values: readonly number[]) => Math.sqrt(values.reduce((sum, value) => sum + value ** 2, 0) / values.length);

describe("the visitors of a forest that the server does not step", () => {
  beforeEach(() => {
    vi.useFakeTimers();
    vi.stubGlobal("WebSocket", Line);
    server = new Server();
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  function meet(seed: number, away_m = 180): [Visitor, Visitor] {
    const next = seededRandom(seed);
    delay_ms = () => 5 + 40 * next();
    const placement = placementOf(next);
    return [new Visitor(placement, 0, [-away_m, 0]), new Visitor(placement, 77, [away_m, 0.4 * away_m])];
  }

  function play(visitors: readonly Visitor[], span_s: number): void {
    for (let frame = 0; frame * FRAME_MS < span_s * 1000; frame++) {
      if (frame % 63 === 0) server.tellClock();
      vi.advanceTimersByTime(FRAME_MS);
      for (const visitor of visitors) visitor.advance();
    }
  }

  // the farther away, the less often trees are stepped
  test.each([
    [21, 180, 0.12],
    [22, 180, 0.12],
    [21, 250, 0.25],
    [22, 250, 0.25],
  ])("see a gust pass the same tree at the same time, and the trees sway alike (seed %d, %d m away, to %d)", (seed, away_m, most) => {
    const [one, other] = meet(seed, away_m);
    play([one, other], 14);
    for (const { felt_s } of [one, other]) felt_s.fill(Number.NaN); // the winds that they had before
    play([one, other], 1);
    const calm = one.sway;
    expect([...one.felt_s, ...other.felt_s].every(Number.isNaN)).toBe(true);
    other.motion.gust(-90, 10);
    let [apart, sway] = [0, 0];
    for (let time_s = 0; time_s < 25; time_s += 0.5) {
      play([one, other], 0.5);
      const [mine, theirs] = [one.sway, other.sway];
      apart = Math.hypot(apart, rms(mine.map((value, tree) => value - theirs[tree])));
      sway = Math.hypot(sway, rms(mine.map((value, tree) => value - calm[tree])));
    }
    const reached = [...one.felt_s.keys()].filter((tree) => !Number.isNaN(one.felt_s[tree]));
    const moments_s = reached.map((tree) => one.felt_s[tree]);
    console.log(`${reached.length} trees within ${Math.max(...moments_s) - Math.min(...moments_s)} s; sway apart by ${apart / sway}`);
    expect(reached.length).toBeGreaterThan(20);
    expect(Math.max(...moments_s) - Math.min(...moments_s)).toBeGreaterThan(3);
    for (const tree of reached) expect(Math.abs(one.felt_s[tree] - other.felt_s[tree])).toBeLessThan(0.06);
    expect(apart).toBeLessThan(most * sway);
  });

  test("follow the hands of each other, wherever the tree stands (seed 23)", () => {
    const visitors = meet(23);
    const [one, other] = visitors;
    play(visitors, 2);
    const order = (reach_m: number) => ({ hand: 9, at: { group: 0, tree: 217 }, vertex: 5, target_m: [reach_m, 0, 0] as const });
    one.motion.pull(order(0.1));
    play(visitors, 0.5);
    one.motion.pull(order(0.2));
    play(visitors, 0.5);
    expect(other.motion.pulled.map((pulled) => pulled.order)).toEqual([order(0.2)]);
    one.motion.release(9);
    play(visitors, 0.5);
    expect(other.motion.local.hands.hands.length).toBe(0);
  });
});
