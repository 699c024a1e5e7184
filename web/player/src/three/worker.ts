/** Starts the worker and talks to it: one frame is on its way at any time, and its buffers circulate. */

import type { Viewer } from "../core/motion/simulationLevels";
import type { DrawnMotion } from "../core/table/drawnTable";
import type { WindDocument } from "../core/wind/document";
import type { WorkerPort } from "../worker/divided/dividedWorker";
import type { Floats, FromWorker, GroupFrame, ToWorker } from "../worker/simple/messages";
import { startAt } from "./start";

/** Longer pauses, for example of a hidden tab, are skipped. */
const MAX_STEP_S = 0.25;

/** Browsers do not say why the file of a worker does not start. */
const UNREADABLE_FILE =
  "its file could not be loaded (does the Content-Security-Policy allow it as worker-src?)";

/** The worker is a file beside this one. */
export const startWorker = (): Worker =>
  startAt(
    () => new Worker(new URL("./galewood.worker.js", import.meta.url), { type: "module" }),
    () => new URL("./galewood.worker.js", import.meta.url),
  );

interface Waiting {
  resolve(motion: DrawnMotion): void;
  reject(error: Error): void;
}

interface GroupBuffers {
  readonly floats: number;
  readonly trees: number;
  /** Newest poses; null until the first arrive. */
  poses: Floats | null;
  spare: Floats;
  velocity: Floats;
}

/** Writes the velocity at each tree of a group, x and z (m/s). */
export type Blow = (group: number, velocity: Floats, time_s: number) => void;

export class WorkerClient {
  time_s = 0;
  /** Called with the reason when the worker cannot run. */
  failed: (fault: string) => void = () => {};
  private readonly waiting = new Map<number, Waiting>();
  private readonly groups = new Map<number, GroupBuffers>();
  private tables = 0;
  private planted = 0;
  private busy = false;
  private backlog_s = 0;
  private fresh = false;
  /** Why the worker no longer runs. */
  private ended: Error | null = null;

  constructor(private readonly worker: WorkerPort) {
    worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
    worker.onerror = (event) => this.fail(event.message || UNREADABLE_FILE);
  }

  private fail(reason: string): void {
    this.end(new Error(`The forest worker is not running: ${reason}`));
  }

  private end(error: Error): void {
    this.ended = error;
    for (const { reject } of this.waiting.values()) reject(error);
    this.waiting.clear();
    this.failed(error.message);
  }

  private send(message: ToWorker, transfer: Transferable[] = []): void {
    this.worker.postMessage(message, transfer);
  }

  /** Loads a table; returns its number and what drawing needs of it. */
  load(from: string | ArrayBuffer): Promise<{ table: number; motion: DrawnMotion }> {
    const table = this.tables++;
    if (this.ended) return Promise.reject(this.ended);
    return new Promise((resolve, reject) => {
      this.waiting.set(table, { resolve: (motion) => resolve({ table, motion }), reject });
      this.send({ kind: "load", table, from });
    });
  }

  /** Plants trees of a table; returns the number of the group. */
  plant(table: number, placement: Floats, stride: number): number {
    const group = this.planted++;
    const trees = placement.length / 4;
    const floats = trees * stride;
    const buffers = { spare: new Float32Array(floats), velocity: new Float32Array(2 * trees) };
    this.groups.set(group, { floats, trees, poses: null, ...buffers });
    this.send({ kind: "plant", group, table, placement });
    return group;
  }

  move(group: number, table: number, placement: Floats): void {
    this.send({ kind: "plant", group, table, placement });
  }

  remove(group: number): void {
    this.groups.delete(group);
    this.send({ kind: "remove", group });
  }

  /** null: a function blows. */
  setWind(wind: WindDocument | null): void {
    this.send({ kind: "wind", wind });
  }

  /** Newest poses of a group. */
  poses(group: number): Floats | null {
    return this.groups.get(group)?.poses ?? null;
  }

  /** Advances by a display step. While the worker is busy, the time accumulates. */
  advance(dt_s: number, viewer: Viewer, blow: Blow | null): void {
    this.backlog_s = Math.min(MAX_STEP_S, this.backlog_s + dt_s);
    if (this.busy || this.groups.size === 0 || this.ended) return;
    this.busy = true;
    const frames: GroupFrame[] = [];
    for (const [group, { spare, velocity }] of this.groups) {
      blow?.(group, velocity, this.time_s + this.backlog_s);
      frames.push({ group, poses: spare, velocity: blow && velocity });
    }
    const message: ToWorker = { kind: "advance", dt_s: this.backlog_s, viewer, frames };
    this.backlog_s = 0;
    this.send(
      message,
      frames.flatMap(({ poses, velocity }) => (velocity ? [poses.buffer, velocity.buffer] : [poses.buffer])),
    );
  }

  /** Whether new poses have arrived since the last call. */
  takeFresh(): boolean {
    const { fresh } = this;
    this.fresh = false;
    return fresh;
  }

  private receive(message: FromWorker): void {
    if (message.kind === "poses") this.receivePoses(message.time_s, message.frames);
    else {
      const waiting = this.waiting.get(message.table);
      this.waiting.delete(message.table);
      if (message.kind === "table") waiting?.resolve(message.motion);
      else waiting?.reject(new Error(message.fault));
    }
  }

  private receivePoses(time_s: number, frames: readonly GroupFrame[]): void {
    for (const { group, poses, velocity } of frames) {
      const buffers = this.groups.get(group);
      if (!buffers) continue; // removed meanwhile
      buffers.spare = buffers.poses ?? new Float32Array(buffers.floats);
      buffers.poses = poses;
      if (velocity) buffers.velocity = velocity;
    }
    this.time_s = time_s;
    this.busy = false;
    this.fresh = true;
  }

  dispose(): void {
    this.worker.terminate();
    this.end(new DOMException("the forest was disposed of", "AbortError"));
  }
}
