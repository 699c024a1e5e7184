/** One of the workers of a forest: what it has, and what it has not been told or has not answered yet. */
import { type PosePacket, packetBuffers } from "../../core/motion/posePacket";
import type { Viewer } from "../../core/motion/simulationLevels";
import type { FromWorker, ShownTrees, ToWorker } from "../protocol";
import type { Share } from "./shares";

export type Poses = Extract<FromWorker, { kind: "poses" }>;

/** What happens to a worker. */
export interface MemberEvents {
  receive(message: FromWorker, member: Member): void;
  /** It runs no more. */
  lost(reason: string, member: Member): void;
}

/** Browsers do not say why the file of a worker does not start. */
const UNREADABLE_FILE = "its file could not be loaded";

export class Member {
  /** What it has of the plan. */
  share: Share = { groups: [], parts: [] };
  /** What others have displayed of it. */
  handed: readonly ShownTrees[] = [];
  /** Whether it has had a plan, and with it the forest's clock and wind. */
  joined = false;
  /** Time that it has yet to be told of, s. */
  backlog_s = 0;
  /** The poses that it sent last. */
  newest: Poses | null = null;
  /** Hashes of the tables that it was told to load, and of those that it has. */
  private readonly ordered = new Set<string>();
  private readonly loaded = new Set<string>();
  /** Requests for poses that it has not answered. */
  private pending = 0;
  private spare: PosePacket | null = null;

  constructor(
    private readonly worker: Worker,
    events: MemberEvents,
  ) {
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if (data.kind === "table") this.loaded.add(data.motion.sha256);
      if (data.kind === "tableFailed") this.ordered.delete(data.sha256);
      if (data.kind === "poses") this.take(data);
      events.receive(data, this);
    };
    worker.onerror = ({ message }) => events.lost(message || UNREADABLE_FILE, this);
  }

  private take(poses: Poses): void {
    this.pending--;
    this.newest = poses;
    this.spare = poses.packet;
  }

  get isBusy(): boolean {
    return this.pending > 0;
  }

  send(message: ToWorker, transfer: Transferable[] = []): void {
    this.worker.postMessage(message, transfer);
  }

  load(sha256: string, url: string): void {
    this.ordered.add(sha256);
    this.send({ kind: "load", sha256, url });
  }

  /** Loads a table unless it has been told so. */
  ensure(sha256: string, url: string): void {
    if (!this.ordered.has(sha256)) this.load(sha256, url);
  }

  /** Tables that it needs before it can have the plan. */
  get tables(): string[] {
    return [...this.share.groups, ...this.handed].map(({ table }) => table);
  }

  /** Whether these have arrived. */
  get isReady(): boolean {
    return this.tables.every((sha256) => this.loaded.has(sha256));
  }

  plan(message: Extract<ToWorker, { kind: "plan" }>): void {
    this.pending++;
    this.joined = true;
    this.handed = [];
    this.spare = null;
    this.send(message);
  }

  /** Tells it of the time since its last step. The packet that it sent last must have been taken over. */
  advance(epoch: number, viewer: Viewer): void {
    const { spare, backlog_s: dt_s } = this;
    this.pending++;
    this.spare = null;
    this.backlog_s = 0;
    this.send({ kind: "advance", epoch, dt_s, viewer, spare }, spare ? packetBuffers(spare) : []);
  }

  end(): void {
    this.worker.onmessage = null;
    this.worker.onerror = null;
    this.worker.terminate();
  }
}
