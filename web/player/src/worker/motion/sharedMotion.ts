/** Poses computed here with the wind and clock of a shared forest. */
import type { Viewer } from "../../core/motion/simulationLevels";
import type { WindDocument } from "../../core/wind/document";
import type { WindField } from "../../core/wind/field";
import { parseState } from "../../core/wind/transition";
import type { Pulls, Reply, Request } from "../../core/wire/wire";
import type { Connection, Inspection, PullOrder, TreeAt } from "../protocol";
import { ForestSocket } from "../stream/forestSocket";
import { SharedClock } from "../stream/sharedClock";
import { WindSender } from "../stream/windSender";
import type { LocalMotion } from "./localMotion";
import type { MotionSource } from "./motionSource";
import type { Pulled } from "./pulls/pulled";
import { treeAtPlace } from "./pulls/pulled";
import { PullSender } from "./pulls/pullSender";

export interface SharedMotionOptions {
  readonly url: string;
  /** x, z, yaw, scale of each tree, by group. */
  readonly placements: readonly Float32Array[];
  request(): Request;
  /** Receives SHARED, WIND_STATE and PRESENCE. */
  onReply(reply: Reply): void;
  problem(title: string, hint: string, code?: string): void;
}

const STALE_MS = 3000;

export class SharedMotion implements MotionSource {
  private readonly socket: ForestSocket;
  private readonly clock: SharedClock;
  private clockReceived_ms = Number.NaN;
  private readonly sender: PullSender;
  private readonly windSender = new WindSender((request) => this.socket.send(request));
  /** Hands of this page, which it need not be told of. */
  private readonly own = new Set<number>();
  /** The trees in the hands of others, which are searched for among all trees once. */
  private readonly followed = new Map<
    number,
    { readonly x: number; readonly z: number; readonly at: TreeAt | null }
  >();

  constructor(
    readonly local: LocalMotion,
    private readonly field: WindField,
    private readonly options: SharedMotionOptions,
  ) {
    this.socket = new ForestSocket(options.url, {
      ...options,
      opened: () => this.windSender.reconnected(),
      reply: (reply) => this.reply(reply),
    });
    this.clock = new SharedClock(this.socket.clock);
    this.sender = new PullSender(options.placements, (request) => this.socket.send(request));
  }

  private reply(reply: Reply): void {
    if (reply.type === "clock") {
      this.clock.update(reply);
      this.clockReceived_ms = performance.now();
      this.socket.arrived();
    } else if (reply.type === "pulls") this.follow(reply);
    else if (reply.type === "windState") {
      this.windSender.answered();
      this.field.state = parseState(reply.state);
    }
    if (reply.type === "windState" || reply.type === "shared" || reply.type === "presence")
      this.options.onReply(reply);
  }

  /** Pulls of others, followed here towards the same targets. */
  private follow({ pulls }: Pulls): void {
    const others = pulls.filter(({ hand }) => !this.own.has(hand));
    const hands = new Set(others.map(({ hand }) => hand));
    for (const hand of this.local.hands.hands)
      if (!hands.has(hand) && !this.own.has(hand)) this.local.release(hand);
    for (const hand of this.followed.keys()) if (!hands.has(hand)) this.followed.delete(hand);
    for (const { hand, x, z, vertex, target } of others) {
      const at = this.treeOf(hand, x, z);
      if (at) this.local.pull({ hand, at, vertex, target_m: target });
    }
  }

  private treeOf(hand: number, x: number, z: number): TreeAt | null {
    const known = this.followed.get(hand);
    if (known?.x === x && known.z === z) return known.at;
    const at = treeAtPlace(this.options.placements, x, z);
    this.followed.set(hand, { x, z, at });
    return at;
  }

  pull(order: PullOrder): void {
    this.own.add(order.hand);
    this.local.pull(order);
    this.sender.pull(order, performance.now());
  }

  release(hand: number): void {
    this.local.release(hand);
    this.sender.release(hand);
  }

  get pulled(): Pulled[] {
    return this.local.pulled;
  }

  gust(x: number, z: number): void {
    this.socket.send({ type: "gust", x, z });
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

  sendWind(wind: WindDocument): void {
    this.windSender.change(wind);
  }

  pause(paused: boolean): void {
    this.socket.send({ type: "pause", paused });
  }

  see(viewer: Viewer): void {
    this.local.see(viewer);
  }

  get changed() {
    return this.local.changed;
  }

  watch(at: TreeAt | null): void {
    this.local.watch(at);
  }

  retry(): void {
    this.socket.retry();
  }

  hide(hidden: boolean): void {
    this.socket.suspend(hidden);
    // The forest has gone on meanwhile: wait for its clock.
    if (!hidden) this.clockReceived_ms = Number.NaN;
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    this.sender.flush(performance.now());
    const step = this.clock.step(this.local.time_s, dt_s, performance.now());
    if (step.jump_s !== null) this.local.time_s = step.jump_s;
    return this.local.advance(step.dt_s, out);
  }

  dispose(): void {
    this.windSender.dispose();
    this.socket.dispose();
    this.local.dispose();
  }
}
