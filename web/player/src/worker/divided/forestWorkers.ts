/**
 * The workers of a forest as if they were one. Those of a large forest divide its trees; each has its own tables, and all
 * have the same wind and clock, so that a tree moves as in a single one. Their poses are passed on as they arrive: trees of a
 * worker that is late stay where they were, and it takes one longer step afterwards.
 */
import type { PosePacket } from "../../core/motion/posePacket";
import type { Viewer } from "../../core/motion/simulationLevels";
import type { WindDocument } from "../../core/wind/document";
import type { ForestPlan, FromWorker, ShownTrees, ToWorker } from "../protocol";
import { Member, type MemberEvents, type Poses } from "./member";
import { isDivisible, MOST_LATE_S, type PartOfGroup, sharesOf, treeIn, treeOf, workersFor } from "./shares";

/** Workers that are replaced before the forest is given up. */
const MOST_LOST = 3;

/** Poses of a worker, and which trees it has. */
interface SharePacket {
  readonly packet: PosePacket;
  readonly parts: readonly PartOfGroup[];
}

export type FromWorkers =
  | Exclude<FromWorker, { kind: "poses" }>
  | (Omit<Poses, "packet" | "epoch"> & {
      /** Those that have arrived: of all workers after a plan, otherwise of one. */
      readonly packets: readonly SharePacket[];
      /** Whether they are the first of the newest plan. */
      readonly planned: boolean;
    });

/** A plan, with what goes with it. */
export interface PlanOrder {
  readonly plan: Omit<ForestPlan, "epoch">;
  readonly wind: WindDocument;
  readonly socketUrl: string;
  /** Number of workers that divide it if possible; null: by trees and processor cores. */
  readonly workers: number | null;
}

/** What is passed on to the workers. */
export type Order = Exclude<ToWorker, { kind: "plan" | "advance" }>;

export class ForestWorkers {
  private readonly members: Member[] = [];
  private epoch = 0;
  private order: PlanOrder | null = null;
  /** Whether the first poses of the newest plan have been passed on. */
  private planned = false;
  /** Workers that the newest plan has yet to be sent to, and messages that wait for that. */
  private readonly waiting = new Set<Member>();
  private readonly held: Order[] = [];
  private readonly urls = new Map<string, string>();
  /** Tables that the page waits for. */
  private readonly asked = new Set<string>();
  private latest: Poses | null = null;
  private viewer: Viewer = [0, 0];
  private lost = 0;
  private readonly events: MemberEvents = {
    receive: (message, member) => this.hear(message, member),
    lost: (reason, member) => this.replace(reason, member),
  };

  /** `shown`: the trees that are displayed. `cores`: of the processor. */
  constructor(
    private readonly start: () => Worker,
    private readonly cores: number,
    private readonly shown: () => readonly ShownTrees[],
    private readonly receive: (message: FromWorkers) => void,
  ) {
    this.members.push(this.recruit());
  }

  private recruit(): Member {
    const member = new Member(this.start(), this.events);
    for (const sha256 of this.asked) this.ensure(member, sha256);
    return member;
  }

  private ensure(member: Member, sha256: string): void {
    member.ensure(sha256, this.urls.get(sha256) ?? "");
  }

  /** Whether a request is still unanswered. */
  get isBusy(): boolean {
    return (this.epoch > 0 && !this.planned) || this.members.some(({ isBusy }) => isBusy);
  }

  send(order: Order): void {
    if (order.kind === "load") this.load(order.sha256, order.url);
    else if (this.waiting.size > 0) this.held.push(order);
    else this.pass(order);
  }

  private load(sha256: string, url: string): void {
    this.urls.set(sha256, url);
    this.asked.add(sha256);
    for (const member of this.members) member.load(sha256, url);
  }

  private pass(order: Order): void {
    this.keepTime();
    if (order.kind === "loadRecords") {
      this.members[0]?.send(order); // it plays what needs them, alone
      return;
    }
    for (const member of this.members) {
      if (order.kind === "pull" || order.kind === "watch") {
        const { at } = order.kind === "pull" ? order.order : order;
        const own = at && treeIn(member.share, at);
        if (order.kind === "watch") member.send({ kind: "watch", at: own });
        else if (own) member.send({ kind: "pull", order: { ...order.order, at: own } });
      } else member.send(order);
    }
  }

  /** Tells workers of time that they have missed, so that what follows happens for all at the same time. */
  private keepTime(): void {
    const { members } = this;
    if (!this.planned || members.every(({ backlog_s }) => backlog_s === members[0].backlog_s)) return;
    for (const member of members) if (member.backlog_s > 0) member.advance(this.epoch, this.viewer);
  }

  /** Replaces the set of trees; those that stay keep their state. */
  plan(order: PlanOrder): void {
    this.keepTime();
    this.order = order;
    this.divide(order, false);
  }

  /** `lost`: a worker has ended, whose trees others get. */
  private divide(order: PlanOrder, lost: boolean): void {
    const { members, waiting } = this;
    if (this.isOver) return;
    const count = this.workersOf(order);
    const known = count === members.length && !lost ? [] : this.shown();
    const fewer = lost || count < members.length;
    this.epoch++;
    this.planned = false;
    for (const member of members.splice(count)) member.end();
    while (members.length < count) members.push(this.recruit());
    waiting.clear();
    for (const [k, share] of sharesOf(order.plan.groups, count).entries()) {
      const member = members[k];
      member.share = share;
      member.handed = fewer || !member.joined ? known : [];
      member.backlog_s = members[0].backlog_s;
      waiting.add(member);
      for (const sha256 of member.tables) this.ensure(member, sha256);
    }
    this.sendPlans();
  }

  private workersOf({ plan, workers }: PlanOrder): number {
    if (!isDivisible(plan)) return 1;
    const trees = plan.groups.reduce((sum, { ids }) => sum + ids.length, 0);
    return Math.max(1, (workers ?? workersFor(trees, this.cores)) - this.lost);
  }

  /** Sends the plan to those that can have it: a new worker gets clock and wind from the first answer of another one. */
  private sendPlans(): void {
    const { order, members, epoch, waiting } = this;
    if (!order) return;
    const timed = members.some(({ joined }) => joined);
    for (const [k, member] of members.entries()) {
      const from = member.joined ? null : this.clockFor(timed || k > 0);
      if (!waiting.has(member) || from === "later" || !member.isReady) continue;
      waiting.delete(member);
      const { plan, socketUrl } = order;
      const { handed: shown } = member;
      const { groups } = member.share;
      const from_s = from?.time_s ?? plan.from_s;
      const wind = from?.wind.state ?? order.wind;
      member.plan({ kind: "plan", plan: { ...plan, groups, epoch, from_s }, wind, socketUrl, shown });
    }
    if (waiting.size === 0) for (const message of this.held.splice(0)) this.pass(message);
  }

  /** The answer from which a new worker takes clock and wind; null: it begins them. `waits`: until another has answered. */
  private clockFor(waits: boolean): Poses | "later" | null {
    if (!waits) return this.latest;
    const answered = this.members.find(({ newest }) => newest?.epoch === this.epoch);
    return answered?.newest ?? "later";
  }

  /** Advances the forest by a display step. Time accumulates for workers that are busy. */
  advance(dt_s: number, viewer: Viewer): void {
    const { members } = this;
    this.viewer = viewer;
    const late_s = Math.max(...members.map(({ backlog_s }) => backlog_s));
    const step_s = Math.min(dt_s, MOST_LATE_S - late_s);
    for (const member of members) {
      member.backlog_s += step_s;
      if (this.planned && !member.isBusy) member.advance(this.epoch, viewer);
    }
  }

  private hear(message: FromWorker, member: Member): void {
    if (message.kind === "poses") this.hearPoses(message, member);
    else if (message.kind === "table") this.hearTable(message);
    else if (message.kind !== "tableFailed") this.receive(message);
    else if (this.asked.delete(message.sha256)) this.receive(message);
    else if (this.waiting.has(member) && member.tables.includes(message.sha256))
      this.replace(message.title, member);
  }

  /** The page needs a table once; a new worker has the others' tables, too. */
  private hearTable(message: Extract<FromWorker, { kind: "table" }>): void {
    if (this.asked.delete(message.motion.sha256)) this.receive(message);
    if (!this.planned) this.sendPlans();
  }

  private hearPoses(message: Poses, member: Member): void {
    if (message.epoch !== this.epoch) return;
    this.latest = message;
    if (this.planned) {
      this.deliver([member], false);
      return;
    }
    this.sendPlans();
    if (!this.members.every(({ newest }) => newest?.epoch === this.epoch)) return;
    this.planned = true;
    this.deliver(this.members, true);
  }

  /** Passes on the poses of these workers, with the figures of all. */
  private deliver(from: readonly Member[], planned: boolean): void {
    const all = this.members.flatMap(({ newest, share }) => (newest ? [{ ...newest, share }] : []));
    const [first] = all;
    const slowest = all.reduce((a, b) => (b.work.total_ms > a.work.total_ms ? b : a));
    this.receive({
      kind: "poses",
      planned,
      packets: from.flatMap(({ newest, share: { parts } }) =>
        newest ? [{ packet: newest.packet, parts }] : [],
      ),
      time_s: Math.max(...all.map(({ time_s }) => time_s)),
      work: slowest.work,
      connection: first.connection,
      wind: { state: first.wind.state, coverage: coverageOf(all) },
      extrapolationRatio: Math.max(...all.map(({ extrapolationRatio }) => extrapolationRatio)),
      watched: all.find(({ watched }) => watched)?.watched ?? null,
      pulled: all.flatMap(({ pulled, share }) =>
        pulled.map((tree) => ({ ...tree, at: treeOf(share, tree.at) })),
      ),
    });
  }

  /** Whether workers have ended so often that there are none any more. */
  private get isOver(): boolean {
    return this.lost > MOST_LOST;
  }

  /** Ends a worker and gives its trees to the others, or to a new one if it was the only one. */
  private replace(reason: string, member: Member): void {
    member.end();
    this.keepTime();
    this.members.splice(this.members.indexOf(member), 1);
    this.lost++;
    if (this.isOver) {
      this.dispose();
      const hint = `${reason}. Reload the page; if that does not help, another browser may.`;
      this.receive({ kind: "problem", title: "The trees have stopped moving", hint, code: null });
    } else {
      if (this.members.length === 0) this.members.push(this.recruit());
      if (this.order) this.divide(this.order, true);
    }
  }

  dispose(): void {
    for (const member of this.members.splice(0)) member.end();
  }
}

/** Share of the trees of all workers within the sampled range of winds. */
function coverageOf(
  all: readonly { readonly wind: Poses["wind"]; readonly share: Member["share"] }[],
): number {
  let [trees, covered] = [0, 0];
  for (const { wind, share } of all) {
    const own = share.groups.reduce((sum, { ids }) => sum + ids.length, 0);
    trees += own;
    covered += own * wind.coverage;
  }
  return trees === 0 ? 1 : covered / trees;
}
