/**
 * Several workers that pass for the one of a forest of `galewood/three`: each steps some trees of every group, in the same
 * wind and by the same clock, so that every tree moves as in a single one.
 */
import type { Floats, FromWorker, GroupFrame, ToWorker } from "../simple/messages";
import { DIVIDED_GROUP_TREES, MOST_LATE_S } from "./shares";

/** Trees that stay together, so that poses are copied in long pieces. */
const BLOCK_TREES = 32;
/** Poses are passed on without those of a worker that has not answered for this long. */
const PATIENCE_MS = 50;
const PLACE_FLOATS = 4;
const VELOCITY_FLOATS = 2;

/** What a forest needs of its worker. */
export interface WorkerPort {
  onmessage: ((event: MessageEvent) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
  postMessage(message: unknown, transfer: Transferable[]): void;
  terminate(): void;
}

type Advance = Extract<ToWorker, { kind: "advance" }>;

/** The trees of a group, and the only worker that has them; null: all have some. */
interface Group {
  readonly trees: number;
  readonly home: number | null;
}

interface Member {
  readonly port: WorkerPort;
  /** Its newest poses of each group. */
  readonly poses: Map<number, Floats>;
  /** Buffers that it can fill. */
  readonly spare: Map<number, Floats>;
  pending: number;
  /** Time that it has yet to be told of, s. */
  backlog_s: number;
}

export class DividedWorker implements WorkerPort {
  onmessage: ((event: MessageEvent) => void) | null = null;
  onerror: ((event: ErrorEvent) => void) | null = null;
  private readonly members: readonly Member[];
  private readonly groups = new Map<number, Group>();
  /** Workers that have yet to load each table. */
  private readonly loading = new Map<number, number>();
  /** What is to be answered, and the newest request, answered or not. */
  private request: Advance | null = null;
  private newest: Advance | null = null;
  /** Those whose answers the request waits for. */
  private readonly awaited = new Set<Member>();
  private patience: ReturnType<typeof setTimeout> | undefined;
  private time_s = 0;

  constructor(ports: readonly WorkerPort[]) {
    this.members = ports.map((port) => {
      const member = { port, poses: new Map(), spare: new Map(), pending: 0, backlog_s: 0 };
      port.onmessage = ({ data }: MessageEvent<FromWorker>) => this.hear(data, member);
      port.onerror = (event) => this.onerror?.(event);
      return member;
    });
  }

  postMessage(message: ToWorker): void {
    if (message.kind === "advance") this.advance(message);
    else if (message.kind === "plant") this.plant(message);
    else {
      if (message.kind === "load") this.loading.set(message.table, this.members.length);
      if (message.kind === "remove") this.forget(message.group);
      // What begins for all begins at the same time.
      for (const member of this.members) if (member.backlog_s > 0) this.tell(member);
      for (const { port } of this.members) port.postMessage(message, []);
    }
  }

  private forget(group: number): void {
    this.groups.delete(group);
    for (const { poses, spare } of this.members) {
      poses.delete(group);
      spare.delete(group);
    }
  }

  private plant({ kind, group, table, placement }: Extract<ToWorker, { kind: "plant" }>): void {
    const trees = placement.length / PLACE_FLOATS;
    const home = trees < DIVIDED_GROUP_TREES ? group % this.members.length : null;
    const planted = { trees, home };
    this.groups.set(group, planted);
    for (const [k, { port }] of this.members.entries()) {
      const part = new Float32Array(PLACE_FLOATS * this.countOf(planted, k));
      if (part.length === 0) continue;
      this.copy(planted, k, placement, part, PLACE_FLOATS, false);
      port.postMessage({ kind, group, table, placement: part } satisfies ToWorker, []);
    }
  }

  /** Number of trees of a group that a worker has. */
  private countOf({ trees, home }: Group, member: number): number {
    if (home !== null) return home === member ? trees : 0;
    let count = 0;
    const stride = this.members.length * BLOCK_TREES;
    for (let from = member * BLOCK_TREES; from < trees; from += stride)
      count += Math.min(BLOCK_TREES, trees - from);
    return count;
  }

  /** Copies what belongs to a worker's trees from an array of the whole group to one of the part, or back. */
  private copy(
    { trees, home }: Group,
    member: number,
    whole: Floats,
    part: Floats,
    width: number,
    back: boolean,
  ): void {
    const [first, block, stride] =
      home === null
        ? [member * BLOCK_TREES, BLOCK_TREES, this.members.length * BLOCK_TREES]
        : [0, trees, trees];
    let at = 0;
    for (let from = first; from < trees; from += stride) {
      const end = Math.min(trees, from + block);
      const length = width * (end - from);
      if (back) whole.set(part.subarray(at, at + length), width * from);
      else part.set(whole.subarray(width * from, width * end), at);
      at += length;
    }
  }

  private advance(request: Advance): void {
    const late_s = Math.max(...this.members.map(({ backlog_s }) => backlog_s));
    const step_s = Math.min(request.dt_s, MOST_LATE_S - late_s);
    this.request = this.newest = request;
    for (const member of this.members) member.backlog_s += step_s;
    for (const member of this.members) if (member.pending === 0) this.awaited.add(member);
    clearTimeout(this.patience);
    this.patience = setTimeout(() => this.answer(false), PATIENCE_MS);
    for (const member of [...this.awaited]) this.tell(member);
  }

  /** Tells a worker of the time since its last step. */
  private tell(member: Member): void {
    const { newest: request } = this;
    if (!request) return;
    const own = this.members.indexOf(member);
    const frames = request.frames.flatMap(({ group, poses, velocity }): GroupFrame[] => {
      const planted = this.groups.get(group);
      const count = planted ? this.countOf(planted, own) : 0;
      if (!planted || count === 0) return [];
      const part = velocity && new Float32Array(VELOCITY_FLOATS * count);
      if (velocity && part) this.copy(planted, own, velocity, part, VELOCITY_FLOATS, false);
      const floats = (count * poses.length) / planted.trees;
      const spare = member.spare.get(group) ?? new Float32Array(floats);
      member.spare.delete(group);
      return [{ group, poses: spare, velocity: part }];
    });
    const dt_s = member.backlog_s;
    member.backlog_s = 0;
    member.pending++;
    const message: ToWorker = { kind: "advance", dt_s, viewer: request.viewer, frames };
    member.port.postMessage(
      message,
      frames.flatMap(({ poses, velocity }) => (velocity ? [poses.buffer, velocity.buffer] : [poses.buffer])),
    );
  }

  private hear(message: FromWorker, member: Member): void {
    if (message.kind === "poses") {
      member.pending--;
      for (const { group, poses } of message.frames) {
        if (!this.groups.has(group)) continue;
        const before = member.poses.get(group);
        member.poses.set(group, poses);
        if (before) member.spare.set(group, before);
      }
      this.time_s = Math.max(this.time_s, message.time_s);
      if (member.pending === 0) this.awaited.delete(member);
      this.answer(true);
    } else this.hearTable(message);
  }

  /** A table is loaded when all have it, and has failed when one has not. */
  private hearTable(message: Exclude<FromWorker, { kind: "poses" }>): void {
    const left = (this.loading.get(message.table) ?? 0) - 1;
    if (left < 0) return;
    this.loading.set(message.table, message.kind === "failed" ? 0 : left);
    if (left === 0 || message.kind === "failed") this.onmessage?.({ data: message } as MessageEvent);
  }

  /** Passes on the newest poses of all, if every worker has some; `waits`: for those that have yet to answer. */
  private answer(waits: boolean): void {
    const { request, members, groups } = this;
    if (!request || (waits && this.awaited.size > 0)) return;
    const parts = request.frames.flatMap(({ group, poses }) => {
      const planted = groups.get(group);
      return planted ? members.map((member, k) => ({ group, planted, poses, member, k })) : [];
    });
    const owed = parts.some(
      ({ group, planted, member, k }) => this.countOf(planted, k) > 0 && !member.poses.has(group),
    );
    if (owed) return;
    clearTimeout(this.patience);
    this.awaited.clear();
    this.request = null;
    for (const { group, planted, poses, member, k } of parts) {
      const part = member.poses.get(group);
      if (part) this.copy(planted, k, poses, part, poses.length / planted.trees, true);
    }
    const data: FromWorker = { kind: "poses", time_s: this.time_s, frames: request.frames };
    this.onmessage?.({ data } as MessageEvent);
  }

  terminate(): void {
    clearTimeout(this.patience);
    for (const { port } of this.members) port.terminate();
  }
}
