/** The main thread's end of the worker: plans go out, poses come back, buffers circulate. */
import { tableUrl } from "./api";
import type { WindDocument, WindState } from "./wind";
import type { Connection, ForestPlan, FromWorker, TableMotion, ToWorker } from "./worker/protocol";

type Buffers = Float32Array<ArrayBuffer>[];

interface Waiting {
  resolve(motion: TableMotion): void;
  reject(error: Error): void;
}

const NO_CONNECTION: Connection = { state: "idle", latency_ms: null, frameAge_ms: null, kB_s: 0 };
/** Longer pauses (a hidden tab) are not caught up. */
const MAX_STEP_S = 0.25;

export class ForestClient {
  /** Newest poses, one buffer per moving group. */
  poses: Buffers = [];
  time_s = 0;
  lookup_ms = 0;
  connection = NO_CONNECTION;
  wind: { state: WindState; coverage: number } | null = null;
  private readonly worker = new Worker(new URL("./worker/forest.worker.ts", import.meta.url), {
    type: "module",
  });
  private readonly waiting = new Map<string, Waiting[]>();
  private epoch = 0;
  private spare: Buffers = [];
  private busy = false;
  private owed_s = 0;
  private fresh = false;

  constructor(private readonly problem: (title: string, hint: string) => void) {
    this.worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
  }

  private send(message: ToWorker, transfer: Transferable[] = []): void {
    this.worker.postMessage(message, transfer);
  }

  loadTable(sha256: string): Promise<TableMotion> {
    return new Promise((resolve, reject) => {
      this.waiting.set(sha256, [...(this.waiting.get(sha256) ?? []), { resolve, reject }]);
      this.send({ kind: "load", sha256, url: new URL(tableUrl(sha256), document.baseURI).href });
    });
  }

  /** Groups with the stride of their table; poses start at rest. */
  plan(
    groups: { motion: TableMotion; placement: Float32Array }[],
    plan: Omit<ForestPlan, "epoch" | "groups">,
    wind: WindDocument,
  ): void {
    this.epoch++;
    const lengths = groups.map(({ motion, placement }) => (placement.length / 4) * motion.stride);
    const make = () => lengths.map((length) => new Float32Array(length));
    this.poses = make();
    this.spare = make();
    this.busy = false;
    const full: ForestPlan = {
      ...plan,
      epoch: this.epoch,
      groups: groups.map(({ motion, placement }) => ({ table: motion.sha256, placement: placement.slice() })),
    };
    const socketUrl = new URL("ws/forest", document.baseURI.replace(/^http/, "ws")).href;
    this.send({ kind: "plan", plan: full, wind, socketUrl });
  }

  setWind(wind: WindDocument): void {
    this.send({ kind: "wind", wind });
  }

  /** Moves the forest on by the display's step; while the worker is busy, time is owed. */
  advance(dt_s: number): void {
    this.owed_s = Math.min(MAX_STEP_S, this.owed_s + dt_s);
    if (this.busy || this.spare.length === 0) return;
    this.busy = true;
    const buffers = this.spare;
    this.spare = [];
    const message: ToWorker = { kind: "advance", epoch: this.epoch, dt_s: this.owed_s, buffers };
    this.owed_s = 0;
    this.send(
      message,
      buffers.map((buffer) => buffer.buffer),
    );
  }

  /** True once after new poses came in. */
  takeFresh(): boolean {
    const { fresh } = this;
    this.fresh = false;
    return fresh;
  }

  private receive(message: FromWorker): void {
    if (message.kind === "poses") this.receivePoses(message);
    else if (message.kind === "table")
      this.settle(message.motion.sha256, ({ resolve }) => resolve(message.motion));
    else if (message.kind === "tableFailed") {
      this.settle(message.sha256, ({ reject }) => reject(new Error(message.title)));
    } else this.problem(message.title, message.hint);
  }

  private settle(sha256: string, end: (waiting: Waiting) => void): void {
    for (const waiting of this.waiting.get(sha256) ?? []) end(waiting);
    this.waiting.delete(sha256);
  }

  private receivePoses(message: Extract<FromWorker, { kind: "poses" }>): void {
    if (message.epoch !== this.epoch) return;
    this.spare = this.poses;
    this.poses = message.buffers;
    this.time_s = message.time_s;
    this.lookup_ms += 0.1 * (message.work_ms - this.lookup_ms);
    this.connection = message.connection;
    this.wind = message.wind;
    this.busy = false;
    this.fresh = true;
  }

  dispose(): void {
    this.worker.terminate();
  }
}
