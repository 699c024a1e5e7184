/** Poses streamed by the server, displayed with a short delay; the connection is restored automatically. */

import { coverageOf, extrapolationRatioOf, GroupWind } from "../../core/motion/groupWind";
import { JointWind } from "../../core/motion/jointWind";
import type { Method } from "../../core/motion/method";
import { poseStride } from "../../core/motion/poseStride";
import type { WindDocument } from "../../core/wind/document";
import type { WindField } from "../../core/wind/field";
import { parseState } from "../../core/wind/transition";
import type { Clock, Frame, Reply, Request } from "../../core/wire/wire";
import type { Connection, Inspection, PullOrder, ShareRequest, TreeAt } from "../protocol";
import { forestRequest } from "../stream/forestRequest";
import { ForestSocket } from "../stream/forestSocket";
import { PoseSum } from "../stream/poseSum";
import { SharedClock } from "../stream/sharedClock";
import { PoseTimeline } from "../stream/timeline";
import { WindSender } from "../stream/windSender";
import type { MotionSource } from "./motionSource";
import type { PointResponses, PulledTable } from "./pulls/pointResponses";
import type { Pulled } from "./pulls/pulled";
import { PullSender } from "./pulls/pullSender";
import { StreamedPulls } from "./pulls/streamedPulls";

export interface StreamGroup {
  readonly table: string;
  readonly scale: Float32Array;
  readonly placement: Float32Array;
  readonly height_m: number;
  readonly sampledPeak_pa: number;
  /** Exponent of the pressure (`dynamicPressure`). */
  readonly streamlined: number;
  readonly pulledTable: PulledTable;
}

export interface StreamOptions {
  readonly url: string;
  readonly method: Method;
  readonly poseEasing: number | null;
  /** The shared forest, if any. */
  readonly share?: ShareRequest | null;
  readonly responses: PointResponses;
  /** Receives SHARED, WIND_STATE and PRESENCE. */
  onReply?(reply: Reply): void;
  problem(title: string, hint: string, code?: string): void;
}

const STALE_MS = 1400;

export class StreamMotion implements MotionSource {
  private readonly socket: ForestSocket;
  private readonly clock: SharedClock;
  private received_ms = Number.NaN;
  private made_s = 0;
  private wind_ms = 0;
  private readonly sum: PoseSum;
  private readonly timeline: PoseTimeline;
  private readonly winds: GroupWind[];
  private readonly joint: JointWind;
  private paused = false;
  private hidden = false;
  private readonly sender: PullSender;
  private readonly windSender = new WindSender((request) => this.socket.send(request));
  private readonly pulls: StreamedPulls;
  pulled: Pulled[] = [];

  constructor(
    private readonly groups: readonly StreamGroup[],
    private readonly field: WindField,
    private readonly options: StreamOptions,
    public time_s: number,
  ) {
    this.sum = new PoseSum(groups.map(({ scale, placement }) => ({ scale, count: placement.length / 4 })));
    this.timeline = new PoseTimeline(
      groups.map(({ scale, placement }) => (placement.length / 4) * poseStride(scale.length)),
    );
    this.winds = groups.map(
      ({ placement, height_m, sampledPeak_pa, streamlined }) =>
        new GroupWind(placement, height_m, sampledPeak_pa, streamlined),
    );
    this.joint = new JointWind(this.winds);
    this.socket = new ForestSocket(options.url, {
      request: () => this.forestRequest(),
      opened: () => {
        if (options.share) this.windSender.reconnected();
        else if (this.stopped) this.sendPause();
      },
      reply: (reply) => this.reply(reply),
      problem: options.problem,
    });
    this.clock = new SharedClock(this.socket.clock);
    const placements = groups.map(({ placement }) => placement);
    this.sender = new PullSender(placements, (request) => this.socket.send(request));
    const tables = groups.map(({ pulledTable }) => pulledTable);
    this.pulls = new StreamedPulls(tables, placements, options.responses);
  }

  get connection(): Connection {
    const { latency_ms, kB_s, lost } = this.socket;
    const silent_ms = performance.now() - this.received_ms;
    if (Number.isNaN(silent_ms)) {
      return { state: lost ? "lost" : "connecting", latency_ms, frameAge_ms: null, kB_s };
    }
    const stale = silent_ms > STALE_MS && !this.clock.paused;
    const age_ms = this.socket.clock.age_ms(this.made_s, performance.now()) ?? silent_ms;
    return {
      state: lost || stale ? "lost" : "live",
      latency_ms,
      frameAge_ms: this.clock.paused ? null : Math.max(0, age_ms),
      kB_s,
    };
  }

  private forestRequest(): Request {
    const { poseEasing, method, share } = this.options;
    return forestRequest("stream", this.groups, this.field, this.time_s, { method, poseEasing, share });
  }

  private reply(reply: Reply): void {
    if (reply.type === "frame") this.frame(reply);
    else if (reply.type === "clock") this.takeClock(reply);
    else if (reply.type === "pulls") this.pulls.receive(reply);
    else if (reply.type === "windState") {
      this.windSender.answered();
      this.field.state = parseState(reply.state);
    }
    if (reply.type === "shared" || reply.type === "windState" || reply.type === "presence")
      this.options.onReply?.(reply);
  }

  private takeClock(clock: Clock): void {
    const resumes = this.clock.paused && !clock.paused;
    this.clock.update(clock);
    if (resumes) this.received_ms = performance.now(); // its frames follow
  }

  private frame(frame: Frame): void {
    if (!this.sum.add(frame)) {
      if (this.sum.fits(frame)) this.socket.send({ type: "resync" });
      return;
    }
    this.socket.arrived();
    this.received_ms = performance.now();
    this.made_s = frame.made_s;
    const poses = this.timeline.take();
    this.sum.write(poses);
    this.timeline.push(frame.time_s, poses);
  }

  pull(order: PullOrder): void {
    this.sender.pull(order, performance.now());
  }

  release(hand: number): void {
    this.sender.release(hand);
  }

  gust(x: number, z: number): void {
    this.socket.send({ type: "gust", x, z });
  }

  sendWind(wind: WindDocument): void {
    this.windSender.change(wind);
  }

  pause(paused: boolean): void {
    this.paused = paused;
    this.sendPause();
  }

  private get stopped(): boolean {
    return this.paused || this.hidden;
  }

  private sendPause(): void {
    this.socket.send({ type: "pause", paused: this.stopped });
  }

  retry(): void {
    this.socket.retry();
  }

  /** The server stops a forest of this page alone, which goes on later from the same pose; a shared one is left. */
  hide(hidden: boolean): void {
    if (this.options.share) {
      this.socket.suspend(hidden);
      if (!hidden) this.received_ms = Number.NaN;
    } else if (hidden !== this.hidden) {
      this.hidden = hidden;
      this.sendPause();
    }
  }

  get coverage(): number {
    return coverageOf(this.winds);
  }

  get extrapolationRatio(): number {
    return extrapolationRatioOf(this.winds);
  }

  takeWind_ms(): number {
    const { wind_ms } = this;
    this.wind_ms = 0;
    return wind_ms;
  }

  inspect({ group, tree }: TreeAt): Inspection | null {
    const wind = this.winds[group];
    return wind && tree < wind.count
      ? { extrapolationRatio: wind.extrapolationRatioAt(tree), record: null }
      : null;
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    const shown_s = this.timeline.advance(dt_s);
    this.sender.flush(performance.now());
    if (!this.timeline.sample(out)) return false;
    this.time_s = shown_s;
    this.pulled = this.pulls.at(shown_s);
    const begin_ms = performance.now();
    const moment = this.field.at(shown_s);
    this.joint.update(this.field, moment);
    for (const [g, wind] of this.winds.entries()) wind.writeSpeeds(out[g], this.groups[g].scale.length);
    this.wind_ms += performance.now() - begin_ms;
    return true;
  }

  dispose(): void {
    this.windSender.dispose();
    this.socket.dispose();
  }
}
