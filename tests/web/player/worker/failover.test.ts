import { describe, expect, it } from "vitest";
import { FailoverMotion } from "../../../../web/player/src/worker/motion/failover";
import type { LocalMotion } from "../../../../web/player/src/worker/motion/localMotion";
import type { ConnectionState } from "../../../../web/player/src/worker/protocol";
import type { StreamMotion } from "../../../../web/player/src/worker/motion/streamMotion";

/** A source whose poses equal its clock, with only the members that the failover uses. */
class Source {
  state: ConnectionState = "live";
  disposed = false;
  winds = 0;
  coverage = 1;
  extrapolationRatio = 0;

  constructor(public time_s: number) {}

  get connection() {
    return { state: this.state, latency_ms: null, frameAge_ms: null, kB_s: 0 };
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    this.time_s += dt_s;
    out[0][0] = this.time_s;
    return true;
  }

  sendWind(): void {
    this.winds++;
  }

  dispose(): void {
    this.disposed = true;
  }
}

function setUp() {
  const stream = new Source(10);
  const locals: Source[] = [];
  const switches: number[] = [];
  const motion = new FailoverMotion(
    stream as unknown as StreamMotion,
    (from_s) => {
      locals.push(new Source(from_s));
      return locals[locals.length - 1] as unknown as LocalMotion;
    },
    () => switches.push(motion.time_s),
  );
  return { stream, locals, switches, motion, out: [new Float32Array(1)] };
}

describe("when the stream of the server is lost", () => {
  it("the local tables continue at the current time, and the stream resumes from theirs", () => {
    const { stream, locals, switches, motion, out } = setUp();
    motion.advance(1, out);
    expect([out[0][0], locals.length]).toEqual([11, 0]);
    stream.state = "lost";
    for (let k = 0; k < 3; k++) motion.advance(1, out);
    expect([out[0][0], motion.time_s, locals.length, switches.length]).toEqual([14, 14, 1, 1]);
    expect(motion.connection.state).toBe("lost");
    stream.state = "live";
    motion.advance(1, out);
    expect([out[0][0], locals[0].disposed, switches.length]).toEqual([14, true, 2]);
    // The same after a second loss.
    stream.state = "lost";
    motion.advance(1, out);
    expect([locals.length, out[0][0]]).toEqual([2, 15]);
  });

  it("the server still receives wind changes, and both sources are disposed", () => {
    const { stream, locals, motion, out } = setUp();
    stream.state = "lost";
    motion.advance(1, out);
    motion.sendWind({} as never);
    expect(stream.winds).toBe(1);
    motion.dispose();
    expect([stream.disposed, locals[0].disposed]).toEqual([true, true]);
  });
});
