/** Lost connections: waiting times, attempts at once, and pages that nobody looks at. */
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import { Backoff } from "../../../../web/player/src/core/net/backoff";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { poseStride } from "../../../../web/player/src/core/motion/poseStride";
import type { WindDocument } from "../../../../web/player/src/core/wind/document";
import { WindField } from "../../../../web/player/src/core/wind/field";
import { PRESETS } from "../../../../web/player/src/core/wind/presets";
import { decodeRequest, encodeReply, type Reply } from "../../../../web/player/src/core/wire/wire";
import type { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import { SharedMotion } from "../../../../web/player/src/worker/motion/sharedMotion";
import { StreamedForest } from "../../../../web/player/src/worker/simple/streamed";
import { followEvents } from "../../../../web/src/page/server/eventStream";
import { forestRequest } from "../../../../web/player/src/worker/stream/forestRequest";
import { ForestSocket } from "../../../../web/player/src/worker/stream/forestSocket";
import { golden, random } from "../../golden";

test("waiting times double up to 30 s and are spread over half of each (seeds 1 to 50)", () => {
  for (let seed = 1; seed <= 50; seed++) {
    const backoff = new Backoff(random(seed));
    for (let attempt = 0; attempt < 20; attempt++) {
      const bound_ms = Math.min(30_000, 250 * 2 ** attempt);
      const wait_ms = backoff.next_ms();
      expect(wait_ms).toBeGreaterThanOrEqual(0.5 * bound_ms);
      expect(wait_ms).toBeLessThanOrEqual(bound_ms);
    }
    backoff.reset();
    expect(backoff.next_ms()).toBeLessThanOrEqual(250);
  }
});

/** A connection of which the test decides how it goes. */
class Line {
  static readonly CONNECTING = 0;
  static readonly OPEN = 1;
  static made: Line[] = [];
  readyState = 0;
  binaryType = "";
  closed = false;
  onopen: (() => void) | null = null;
  onmessage: ((event: unknown) => void) | null = null;
  onclose: (() => void) | null = null;
  onerror: (() => void) | null = null;
  readonly sent: unknown[] = [];

  constructor(readonly url: string) {
    Line.made.push(this);
  }

  static get last(): Line {
    return Line.made[Line.made.length - 1];
  }

  send(data: unknown): void {
    this.sent.push(data);
  }

  close(): void {
    this.closed = true;
    this.readyState = 3;
    this.onclose?.();
  }
}

beforeEach(() => {
  vi.useFakeTimers();
  Line.made = [];
  vi.stubGlobal("WebSocket", Line);
  vi.stubGlobal("EventSource", Line);
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const handlers = { request: () => ({ type: "resync" }) as const, reply: () => {}, problem: () => {} };

describe("the socket", () => {
  test("waits longer after every failed attempt, but not if it is asked to try now", () => {
    // Late attempts, so that the next check comes before the socket gives up an attempt without an answer.
    vi.spyOn(Math, "random").mockReturnValue(0.9);
    const socket = new ForestSocket("ws://here", handlers);
    for (let attempt = 0; attempt < 9; attempt++) {
      Line.last.close();
      expect(socket.lost).toBe(true);
      vi.advanceTimersByTime(0.49 * Math.min(30_000, 250 * 2 ** attempt));
      expect(Line.made.length).toBe(attempt + 1);
      vi.advanceTimersByTime(0.52 * Math.min(30_000, 250 * 2 ** attempt));
      expect(Line.made.length).toBe(attempt + 2);
    }
    Line.last.close();
    socket.retry();
    expect(Line.made.length).toBe(11);
    socket.retry(); // it is being established
    expect(Line.made.length).toBe(11);
    socket.dispose();
    vi.advanceTimersByTime(60_000);
    expect(Line.made.length).toBe(11);
  });

  test("counts a refused request as lost, so that the local tables move the trees, but no later error", () => {
    const problem = vi.fn();
    const socket = new ForestSocket("ws://here", { ...handlers, problem });
    const line = Line.last;
    const refusal = { type: "error", code: "too-many-trees", title: "A forest of 20,001 trees is played by the browsers", hint: "" } as const;
    const refuse = () => line.onmessage?.({ data: encodeReply(refusal).buffer });
    refuse();
    expect(socket.lost).toBe(true);
    expect(problem).toHaveBeenCalledWith(refusal.title, "", refusal.code);
    line.onmessage?.({ data: encodeReply({ type: "pong", t: 0, server_s: 0 }).buffer });
    expect(socket.lost).toBe(true);
    socket.arrived();
    refuse();
    expect(socket.lost).toBe(false);
    socket.dispose();
  });

  test.each([
    ["too-many-trees", 1],
    ["server-full", 2],
  ])("asks again after the refusal %s only if it may pass", (code, asked) => {
    const socket = new ForestSocket("ws://here", handlers);
    Line.last.onmessage?.({ data: encodeReply({ type: "error", code, title: "", hint: "" }).buffer });
    Line.last.close();
    vi.advanceTimersByTime(300);
    expect([Line.made.length, socket.lost]).toEqual([asked, true]);
    socket.suspend(true);
    socket.suspend(false); // the page is looked at again
    expect(Line.made.length).toBe(asked + 1);
    socket.dispose();
  });

  test("gives up a connection that is not established within 10 s", () => {
    const socket = new ForestSocket("ws://here", handlers);
    vi.advanceTimersByTime(12_000);
    expect(Line.made[0].closed).toBe(true);
    expect(Line.made.length).toBe(2);
    socket.dispose();
  });

  test("gives up a silent connection after 5 s, but waits longer for the first data", () => {
    const pong = encodeReply({ type: "pong", t: 0, server_s: 0 }).buffer;
    for (const [answered, closed] of [
      [true, true],
      [false, false],
    ]) {
      const socket = new ForestSocket("ws://here", handlers);
      const line = Line.last;
      line.readyState = Line.OPEN;
      line.onmessage?.({ data: pong });
      if (answered) socket.arrived();
      vi.advanceTimersByTime(9000);
      expect(line.closed).toBe(closed);
      vi.advanceTimersByTime(15_000);
      expect(line.closed).toBe(true);
      socket.dispose();
    }
  });

  test("is closed while nobody looks, without being lost, and opens at once afterwards", () => {
    const socket = new ForestSocket("ws://here", handlers);
    Line.last.readyState = Line.OPEN;
    Line.last.onopen?.();
    expect(Line.last.sent.length).toBeGreaterThan(0);
    socket.suspend(true);
    vi.advanceTimersByTime(120_000);
    socket.retry();
    expect([Line.made.length, Line.last.closed, socket.lost]).toEqual([1, true, false]);
    socket.suspend(false);
    expect([Line.made.length, Line.last.closed]).toEqual([2, false]);
    socket.dispose();
  });
});

/** A streamed forest of one tree, which has asked for a connection. */
function streamed(replant: boolean, wind: WindDocument): StreamedForest {
  const forest = new StreamedForest({ kind: "stream", url: "ws://here", share: "meadow", replant }, () => {});
  const bytes = golden("pole.safetensors");
  forest.read(0, bytes.slice().buffer, `tables/${"a".repeat(64)}`);
  forest.plant(0, 0, Float32Array.of(1, 2, 0, 1));
  forest.setWind(wind);
  const poses = new Float32Array(poseStride(decodeTable(bytes).metadata.modes));
  forest.advance(0.016, null, [{ group: 0, poses } as never]);
  return forest;
}

describe("trees replace those of a shared forest once, and not again when the connection returns:", () => {
  const shared: Reply = {
    type: "shared",
    share: "meadow",
    groups: [],
    pose_easing: null,
    method: "modal",
    about: {},
    trees: new Float32Array(),
  };

  /** Whether the FOREST of a connection that has just been opened replaces the trees. */
  function replants(): boolean | undefined {
    const line = Line.last;
    line.readyState = Line.OPEN;
    line.onopen?.();
    const request = decodeRequest((line.sent[1] as Uint8Array<ArrayBuffer>).slice().buffer);
    return request.type === "forest" ? request.replant : expect.unreachable(request.type);
  }

  function comeBack(): void {
    Line.last.close();
    vi.advanceTimersByTime(600); // after a second failure, 0.5 s at most
  }

  function check(): void {
    expect(replants()).toBe(true);
    comeBack(); // before the server has answered
    expect(replants()).toBe(true);
    Line.last.onmessage?.({ data: encodeReply(shared).buffer });
    comeBack();
    expect(replants()).toBeUndefined();
  }

  test("the page's", async () => {
    const worker = { onmessage: (_: { data: unknown }) => {}, postMessage: () => {} };
    vi.stubGlobal("self", worker);
    await import("../../../../web/player/src/worker/forestWorker");
    const share = { id: "meadow", replant: true, about: {} };
    const plan = { epoch: 1, groups: [], lookup: "worker", from_s: 0, method: "modal", poseEasing: null, share };
    worker.onmessage({ data: { kind: "plan", plan, wind: PRESETS.still, socketUrl: "ws://here", shown: [] } });
    check();
  });

  test("those of a streamed forest of the package", () => {
    streamed(true, PRESETS.still);
    check();
  });
});

describe("a change of the wind while the connection is down is made when it returns:", () => {
  /** What a connection that has just been opened is asked, without greetings and pings. */
  function asked(): string[] {
    const line = Line.last;
    line.readyState = Line.OPEN;
    line.onopen?.();
    return line.sent
      .map((bytes) => decodeRequest((bytes as Uint8Array<ArrayBuffer>).slice().buffer))
      .map((request) => (request.type === "wind" ? `${request.wind.model}` : request.type))
      .filter((kind) => kind !== "hello" && kind !== "ping");
  }

  function check(change: () => void): void {
    expect(asked()).toEqual(["forest"]);
    Line.last.close();
    change();
    vi.advanceTimersByTime(2100);
    expect(asked()).toEqual(["forest", PRESETS["storm-front"].model]);
    Line.last.close(); // before the server has answered
    vi.advanceTimersByTime(2100);
    expect(asked()).toEqual(["forest", PRESETS["storm-front"].model]);
    const state = { ...new WindField(PRESETS["storm-front"]).state };
    Line.last.onmessage?.({ data: encodeReply({ type: "windState", state }).buffer });
    Line.last.close();
    vi.advanceTimersByTime(2100);
    expect(asked()).toEqual(["forest"]);
  }

  test("of a streamed forest", () => {
    const forest = streamed(false, PRESETS.breeze);
    check(() => forest.setWind(PRESETS["storm-front"]));
  });

  test("of one that is played here", () => {
    const placement = Float32Array.of(1, 2, 0, 1);
    const field = new WindField(PRESETS.breeze);
    const groups = [{ table: "a".repeat(64), placement }];
    const share = { id: "meadow", replant: false, about: {} };
    const motion = new SharedMotion({ time_s: 0, dispose: () => {} } as LocalMotion, field, {
      url: "ws://here",
      placements: [placement],
      request: () => forestRequest("table", groups, field, 0, { method: "modal", poseEasing: null, share }),
      onReply: () => {},
      problem: () => {},
    });
    check(() => motion.sendWind(PRESETS["storm-front"]));
    motion.dispose();
  });
});

test("the event stream waits longer after every failed attempt, but not if it is asked to try now", () => {
  const states: boolean[] = [];
  const stream = followEvents({ change: () => {}, open: () => states.push(true), lost: () => states.push(false) });
  for (let attempt = 0; attempt < 8; attempt++) {
    Line.last.onerror?.();
    vi.advanceTimersByTime(0.49 * Math.min(30_000, 250 * 2 ** attempt));
    expect(Line.made.length).toBe(attempt + 1);
    vi.advanceTimersByTime(0.52 * Math.min(30_000, 250 * 2 ** attempt));
    expect(Line.made.length).toBe(attempt + 2);
  }
  Line.last.onerror?.();
  stream.retry();
  expect(Line.made.length).toBe(10);
  Line.last.onopen?.();
  expect(states.at(-1)).toBe(true);
  Line.last.onerror?.();
  vi.advanceTimersByTime(251);
  expect(Line.made.length).toBe(11); // the waiting time starts again after a success
  stream.close();
});
