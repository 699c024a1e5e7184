/** Poses computed here with the wind and clock of a shared forest. */
import { parseState, type WindDocument, type WindField } from "../../core/wind/wind";
import type { Reply, Request } from "../../core/wire/wire";
import type { Connection, Inspection, TreeAt } from "../protocol";
import { ForestSocket } from "../stream/forestSocket";
import { SharedClock } from "../stream/sharedClock";
import type { LocalMotion } from "./localMotion";
import type { MotionSource } from "./motionSource";

export interface SharedMotionOptions {
  readonly url: string;
  request(): Request;
  /** Receives SHARED, WIND_STATE and PRESENCE. */
  onReply(reply: Reply): void;
  problem(title: string, hint: string): void;
}

const STALE_MS = 3000;

export class SharedMotion implements MotionSource {
  private readonly socket: ForestSocket;
  private readonly clock: SharedClock;
  private clockReceived_ms = Number.NaN;

  constructor(
    readonly local: LocalMotion,
    private readonly field: WindField,
    private readonly options: SharedMotionOptions,
  ) {
    this.socket = new ForestSocket(options.url, { ...options, reply: (reply) => this.reply(reply) });
    this.clock = new SharedClock(this.socket.clock);
  }

  private reply(reply: Reply): void {
    if (reply.type === "clock") {
      this.clock.update(reply);
      this.clockReceived_ms = performance.now();
      this.socket.arrived();
    } else if (reply.type === "windState") this.field.state = parseState(reply.state);
    if (reply.type === "windState" || reply.type === "shared" || reply.type === "presence")
      this.options.onReply(reply);
  }

  get time_s(): number {
    return this.local.time_s;
  }

  get connection(): Connection {
    const { latency_ms, kB_s, lost } = this.socket;
    const age_ms = performance.now() - this.clockReceived_ms;
    const stale = lost || age_ms > STALE_MS;
    const state = stale ? "lost" : Number.isNaN(age_ms) ? "connecting" : "live";
    return { state, latency_ms, frameAge_ms: null, kB_s };
  }

  get coverage(): number {
    return this.local.coverage;
  }

  get extrapolationRatio(): number {
    return this.local.extrapolationRatio;
  }

  takeWind_ms(): number {
    return this.local.takeWind_ms();
  }

  inspect(at: TreeAt): Inspection | null {
    return this.local.inspect(at);
  }

  windChanged(wind: WindDocument): void {
    this.socket.send({ type: "wind", wind: { ...wind } });
  }

  pause(paused: boolean): void {
    this.socket.send({ type: "pause", paused });
  }

  retry(): void {
    this.socket.retry();
  }

  hide(hidden: boolean): void {
    this.socket.suspend(hidden);
    // The forest has gone on meanwhile: wait for its clock.
    if (!hidden) this.clockReceived_ms = Number.NaN;
  }

  see(x: number, z: number): void {
    this.local.see(x, z);
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    const step = this.clock.step(this.local.time_s, dt_s, performance.now());
    if (step.jump_s !== null) this.local.time_s = step.jump_s;
    return this.local.advance(step.dt_s, out);
  }

  dispose(): void {
    this.socket.dispose();
    this.local.dispose();
  }
}
