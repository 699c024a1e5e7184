/** Poses looked up on the server: a WebSocket that comes back by itself, shown a moment behind. */
import { poseStride } from "../nodeLayout";
import type { Method } from "../settings";
import { parseState, type WindDocument, type WindField } from "../wind";
import { decodeReply, encodeRequest, type Frame, type Reply, type Request } from "../wire";
import { coverageOf, extentOf, GroupWind } from "./groupWind";
import type { MotionSource } from "./motion";
import { PoseSum } from "./poseSum";
import type { Connection, ConnectionState, Inspection, TreeAt } from "./protocol";
import { PoseTimeline } from "./timeline";

export interface StreamGroup {
  readonly table: string;
  readonly scale: Float32Array;
  readonly placement: Float32Array;
  readonly height_m: number;
  readonly sampledPeak_pa: number;
}

export interface StreamOptions {
  readonly url: string;
  readonly method: Method;
  readonly poseEasing: number | null;
  problem(title: string, hint: string): void;
}

const PING_EVERY_MS = 1000;
/** Short, so that the stream is back soon after the server is; meanwhile the local tables move the trees. */
const RETRY_MS = { first: 250, longest: 1000 } as const;
const STALE_MS = 1400;
/** A connection that has been silent for so long is given up. */
const DEAD_MS = 5000;

export class StreamMotion implements MotionSource {
  private socket: WebSocket | null = null;
  private state: ConnectionState = "connecting";
  private latency_ms: number | null = null;
  private received_ms = Number.NaN;
  private bytes = 0;
  private kB_s = 0;
  private retry_ms: number = RETRY_MS.first;
  private disposed = false;
  private wind_ms = 0;
  private readonly sum: PoseSum;
  private readonly timeline: PoseTimeline;
  private readonly winds: GroupWind[];
  private readonly pinging: ReturnType<typeof setInterval>;

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
      ({ placement, height_m, sampledPeak_pa }) => new GroupWind(placement, height_m, sampledPeak_pa),
    );
    this.pinging = setInterval(() => this.ping(), PING_EVERY_MS);
    this.connect();
  }

  get connection(): Connection {
    const age = performance.now() - this.received_ms;
    const frameAge_ms = Number.isNaN(age) ? null : age;
    const stale = this.state === "live" && frameAge_ms !== null && frameAge_ms > STALE_MS;
    return { state: stale ? "lost" : this.state, latency_ms: this.latency_ms, frameAge_ms, kB_s: this.kB_s };
  }

  private connect(): void {
    const socket = new WebSocket(this.options.url);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.send({ type: "hello", client: "galewood-web" });
      this.send(this.forestRequest());
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer>) => this.receive(event.data);
    socket.onclose = () => {
      if (this.disposed) return;
      this.state = "lost";
      setTimeout(() => !this.disposed && this.connect(), this.retry_ms);
      this.retry_ms = Math.min(RETRY_MS.longest, this.retry_ms * 1.7);
    };
  }

  private send(request: Request): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(encodeRequest(request));
  }

  private forestRequest(): Request {
    const trees = new Float32Array(this.groups.reduce((sum, { placement }) => sum + placement.length, 0));
    let at = 0;
    for (const { placement } of this.groups) {
      trees.set(placement, at);
      at += placement.length;
    }
    return {
      type: "forest",
      mode: "stream",
      groups: this.groups.map(({ table, placement }) => ({ table, count: placement.length / 4 })),
      wind: { ...this.field.state },
      time_s: this.time_s,
      pose_easing: this.options.poseEasing,
      method: this.options.method,
      trees,
    };
  }

  private ping(): void {
    if (performance.now() - this.received_ms > DEAD_MS && this.state === "live") this.socket?.close();
    this.send({ type: "ping", t: performance.now() });
    this.kB_s = this.bytes / PING_EVERY_MS;
    this.bytes = 0;
  }

  private receive(data: ArrayBuffer): void {
    this.bytes += data.byteLength;
    let reply: Reply;
    try {
      reply = decodeReply(data);
    } catch (error) {
      this.options.problem(
        "The stream made no sense.",
        error instanceof Error ? error.message : String(error),
      );
      this.socket?.close();
      return;
    }
    if (reply.type === "frame") this.frame(reply);
    else if (reply.type === "pong") this.latency_ms = performance.now() - reply.t;
    else if (reply.type === "windState") this.field.state = parseState(reply.state);
    else if (reply.type === "error") this.options.problem(reply.title, reply.hint);
  }

  private frame(frame: Frame): void {
    if (!this.sum.add(frame)) {
      if (this.sum.fits(frame)) this.send({ type: "resync" });
      return;
    }
    this.state = "live";
    this.retry_ms = RETRY_MS.first;
    this.received_ms = performance.now();
    const poses = this.timeline.take();
    this.sum.write(poses);
    this.timeline.push(frame.time_s, poses);
  }

  windChanged(wind: WindDocument): void {
    this.send({ type: "wind", wind: { ...wind } });
  }

  get coverage(): number {
    return coverageOf(this.winds);
  }

  get extent(): number {
    return extentOf(this.winds);
  }

  takeWind_ms(): number {
    const { wind_ms } = this;
    this.wind_ms = 0;
    return wind_ms;
  }

  inspect({ group, tree }: TreeAt): Inspection | null {
    const wind = this.winds[group];
    return wind && tree < wind.count ? { coverage: wind.extentAt(tree), record: null } : null;
  }

  advance(dt_s: number, out: readonly Float32Array[]): boolean {
    const shown_s = this.timeline.advance(dt_s);
    if (!this.timeline.sample(out)) return false;
    this.time_s = shown_s;
    const begin_ms = performance.now();
    for (const [g, wind] of this.winds.entries()) {
      wind.blow(this.field, shown_s);
      wind.writeSpeeds(out[g], this.groups[g].scale.length);
    }
    this.wind_ms += performance.now() - begin_ms;
    return true;
  }

  dispose(): void {
    this.disposed = true;
    clearInterval(this.pinging);
    this.socket?.close();
  }
}
