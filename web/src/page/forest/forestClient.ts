/** Client of the workers on the main thread: sends plans, receives poses. */

import type {
  Connection,
  ForestPlan,
  FromWorkers,
  GroupPlan,
  Inspection,
  PulledTree,
  PullOrder,
  ShownTrees,
  TableMotion,
  TreeAt,
  Work,
} from "galewood/client";
import { EasedPoses, ForestWorkers, type Viewer } from "galewood/client";
import { sameWind, type WindState } from "galewood/wind";
import { PullFields } from "../pulling/pullFields";
import { complianceUrl, recordsUrl, tableUrl } from "../server/api";
import { foreignPlacement } from "../settings/sharedForest";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { showToast } from "../ui/toast";

interface Pending<Result> {
  resolve(result: Result): void;
  reject(error: Error): void;
}

const absolute = (path: string) => new URL(path, document.baseURI).href;

/** A group for the worker, with the motion that determines its row length. */
export interface ClientGroup extends Omit<GroupPlan, "table" | "rows"> {
  readonly motion: TableMotion;
}

const NO_CONNECTION: Connection = { state: "idle", latency_ms: null, frameAge_ms: null, kB_s: 0 };
const NO_WORK: Work = { wind_ms: 0, lookup_ms: 0, total_ms: 0 };

/** Starts the worker early, so that it loads while the page builds the scene. */
function startWorker(): Worker {
  return new Worker(new URL("./forest.worker.ts", import.meta.url), { type: "module" });
}

export class ForestClient {
  /** The poses of each moving group. */
  eased: readonly EasedPoses[] = [];
  time_s = 0;
  /** Smoothed worker time per frame; `work` is that of the last frame. */
  lookup_ms = 0;
  work = NO_WORK;
  connection = NO_CONNECTION;
  wind: { state: WindState; coverage: number } | null = null;
  /** Largest extrapolation ratio of all trees; above 1 a tree is beyond its sampled range. */
  extrapolationRatio = 0;
  /** The watched tree's figures. */
  watched: Inspection | null = null;
  /** The trees that are pulled or ring down, by anyone, and their displacements that the modes do not show. */
  pulled: readonly PulledTree[] = [];
  readonly pullFields = new PullFields();
  private readonly workers: ForestWorkers;
  private readonly waiting = new Map<string, Pending<TableMotion>[]>();
  private readonly waitingRecords = new Map<string, Pending<void>>();
  /** Whether planned trees are to replace those of the shared forest, until the server has described it. */
  private replants = false;
  private arrived: (() => void) | null = null;
  /** The groups that are displayed. */
  private groups: readonly ClientGroup[] = [];
  /** Groups and poses of the plan that is on its way. */
  private next: { readonly groups: readonly ClientGroup[]; readonly eased: readonly EasedPoses[] } | null =
    null;
  private fresh = false;

  constructor(private readonly store: Store) {
    const { settings, state } = store;
    this.workers = new ForestWorkers(
      startWorker,
      navigator.hardwareConcurrency,
      () => this.shown,
      (message) => this.receive(message),
    );
    const { workers } = this;
    // The gusts are made while the tables are on their way.
    workers.send({ kind: "wind", wind: settings.wind });
    watch(
      () => [settings.wind],
      ([wind]) => {
        // The worker already knows a wind that others have changed.
        if (!store.isAdopting) workers.send({ kind: "wind", wind });
      },
    );
    // The server need not send anything while nobody looks.
    watch(
      () => [state.away],
      ([hidden]) => workers.send({ kind: "hide", hidden }),
    );
  }

  private get shown(): ShownTrees[] {
    return this.groups.map(({ key, motion, ids }, g) => ({
      key,
      table: motion.sha256,
      ids,
      poses: this.eased[g].poses,
    }));
  }

  loadTable(sha256: string): Promise<TableMotion> {
    return new Promise((resolve, reject) => {
      const waiting = this.waiting.get(sha256);
      this.waiting.set(sha256, [...(waiting ?? []), { resolve, reject }]);
      if (!waiting) this.workers.send({ kind: "load", sha256, url: absolute(tableUrl(sha256)) });
    });
  }

  /** Loads the records of a loaded table, once; the next plan uses them. */
  loadRecords(table: string, records: string): Promise<void> {
    return new Promise((resolve, reject) => {
      this.waitingRecords.set(table, { resolve, reject });
      this.workers.send({ kind: "loadRecords", table, url: absolute(recordsUrl(records)) });
    });
  }

  /** Replaces the set of trees; those that stay keep their state. `arrived` is called with their first poses. */
  plan(
    groups: readonly ClientGroup[],
    plan: Omit<ForestPlan, "epoch" | "groups">,
    arrived: () => void,
  ): void {
    const { share } = plan;
    this.replants ||= share?.replant ?? false;
    const eased = groups.map(({ motion: { modes, levels }, ids }) => {
      const { coordinates } = levels[levels.length - 1];
      return new EasedPoses(ids.length, modes, coordinates);
    });
    this.next = { groups, eased };
    this.arrived = arrived;
    const full = {
      ...plan,
      share: share && { ...share, replant: this.replants },
      groups: groups.map(({ key, motion, leafTable, placement, ids, recorded, compliance }) => ({
        key,
        table: motion.sha256,
        leafTable,
        placement,
        ids,
        rows: null,
        recorded,
        compliance: compliance && absolute(complianceUrl(compliance)),
      })),
    };
    const socketUrl = new URL("ws/forest", document.baseURI.replace(/^http/, "ws")).href;
    const { wind, workers } = this.store.settings;
    this.workers.plan({ plan: full, wind, socketUrl, workers });
  }

  /** Begins or continues a pull. */
  pull(order: PullOrder): void {
    this.workers.send({ kind: "pull", order });
  }

  release(hand: number): void {
    this.workers.send({ kind: "release", hand });
  }

  /** Sends a gust front through the forest from a place, m; also for all who share it. */
  gust(x_m: number, z_m: number): void {
    this.workers.send({ kind: "gust", x_m, z_m });
  }

  /** Stops or resumes the clock of a shared forest, for everyone. */
  pause(paused: boolean): void {
    this.workers.send({ kind: "pause", paused });
  }

  /** Connects to the server at once if the connection is lost. */
  retry(): void {
    this.workers.send({ kind: "retry" });
  }

  /** Requests the figures of one tree with every frame; null or a new plan ends it. */
  watch(at: TreeAt | null): void {
    this.watched = null;
    this.workers.send({ kind: "watch", at });
  }

  /** Newest poses of each moving group; distant trees are still on the way there. */
  get poses(): readonly Float32Array[] {
    return this.eased.map(({ poses }) => poses);
  }

  /** Advances the forest by a display step. */
  advance(dt_s: number, viewer: Viewer): void {
    this.workers.advance(dt_s, viewer);
  }

  /** Whether the trees of the last plan have appeared. */
  get isPlanned(): boolean {
    return this.arrived === null;
  }

  /** Whether the last request is still unanswered. */
  get isBusy(): boolean {
    return this.workers.isBusy;
  }

  /** Whether new poses have arrived since the last call. */
  takeFreshPoses(): boolean {
    const { fresh } = this;
    this.fresh = false;
    return fresh;
  }

  private receive(message: FromWorkers): void {
    if (message.kind === "poses") this.receivePoses(message);
    else if (message.kind === "table")
      this.settle(message.motion.sha256, ({ resolve }) => resolve(message.motion));
    else if (message.kind === "tableFailed") {
      this.settle(message.sha256, ({ reject }) => reject(new Error(message.title)));
    } else if (message.kind === "records") this.settleRecords(message.table, message.fault);
    else if (message.kind === "pullField") this.pullFields.add(message.table, message.vertex, message.field);
    else if (message.kind === "problem") this.complain(message);
    else this.adopt(message);
  }

  /** Shows what went wrong. A forest that is too large for the stream is moved here from now on. */
  private complain({ title, hint, code }: Extract<FromWorkers, { kind: "problem" }>): void {
    const tooLarge = code === "too-many-trees";
    showToast(title, tooLarge ? "This browser computes the motion now." : hint);
    if (tooLarge) this.store.adopt({ lookup: "worker" });
  }

  /** What other clients have changed in a shared forest, and how many there are. */
  private adopt(message: Extract<FromWorkers, { kind: "shared" | "present" | "sharedWind" }>): void {
    const { store } = this;
    if (message.kind === "present") store.state.present = message.clients;
    else if (message.kind === "shared") {
      this.replants = false;
      store.adopt(foreignPlacement(store.settings, message.about));
    } else if (!sameWind(message.wind, store.settings.wind)) store.adopt({ wind: message.wind });
  }

  private settleRecords(table: string, fault: string | null): void {
    const waiting = this.waitingRecords.get(table);
    this.waitingRecords.delete(table);
    if (fault === null) waiting?.resolve();
    else waiting?.reject(new Error(fault));
  }

  private settle(sha256: string, end: (waiting: Pending<TableMotion>) => void): void {
    for (const waiting of this.waiting.get(sha256) ?? []) end(waiting);
    this.waiting.delete(sha256);
  }

  private receivePoses(message: Extract<FromWorkers, { kind: "poses" }>): void {
    const { arrived, next } = this;
    if (message.planned && next) {
      this.arrived = this.next = null;
      ({ groups: this.groups, eased: this.eased } = next);
    }
    if (!this.fresh) for (const poses of this.eased) poses.begin();
    for (const { packet, parts } of message.packets) {
      const at = { row: 0, near: 0, far: 0 };
      for (const [part, { group, rows }] of parts.entries()) this.eased[group].take(packet, part, at, rows);
    }
    this.time_s = message.time_s;
    this.work = message.work;
    this.lookup_ms += 0.1 * (message.work.total_ms - this.lookup_ms);
    this.connection = message.connection;
    this.wind = message.wind;
    this.extrapolationRatio = message.extrapolationRatio;
    this.watched = message.watched;
    this.pulled = message.pulled;
    this.fresh = true;
    if (message.planned) arrived?.();
  }

  dispose(): void {
    this.workers.dispose();
  }
}
