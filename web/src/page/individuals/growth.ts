/** Has the server grow trees, and tells when all are there. */

import type { Individual, Order } from "../../scene/individuals";
import {
  cancelJob,
  deleteTree,
  findIndividuals,
  growIndividual,
  isActive,
  Problem,
  type TreeChange,
} from "../server/api";
import type { Catalogue } from "../server/catalogue";

/** A tree that was asked for, and the job that makes or has made it. */
interface Asked {
  readonly key: string;
  readonly jobId: string | null;
}

/** Trees that are wanted together. */
interface Batch {
  /** By what is asked for, as a text. */
  readonly orders: ReadonlyMap<string, Order>;
  /** Those that were asked for, by their ids on the server. */
  readonly asked: Map<string, Asked>;
  /** Those that are there, and why others could not be grown; by what is asked for. */
  readonly ready: Map<string, Individual>;
  readonly faults: Map<string, string>;
}

/** How growing trees ended. */
export interface Grown {
  readonly trees: readonly Individual[];
  /** Why trees could not be grown, one for each of these. */
  readonly faults: readonly string[];
  /** What kept the page from asking for all of them; null: nothing did. */
  readonly problem: Problem | null;
}

export interface GrowthListener {
  progress(done: number, all: number): void;
  end(grown: Grown): void;
}

/** This server grows no trees. */
export class CannotGrow extends Problem {
  constructor(why: string) {
    super("This server cannot grow trees.", why);
  }
}

const textOf = (order: Order): string => JSON.stringify(order);

const individualOf = (id: string, { species, form, height_m, dbh_cm }: Order): Individual => ({
  id,
  species,
  form,
  height_m,
  dbh_cm,
});

export class Growth {
  private batch: Batch | null = null;
  /** The last change of each tree that a server has grown. */
  private readonly heard = new Map<string, TreeChange>();
  /** Trees whose growth is being ended. */
  private readonly ending = new Set<string>();
  /** Trees that were removed while no batch had asked for them; the answer to a request may arrive after that. */
  private readonly removed = new Set<string>();
  /** Jobs whose end was asked for. */
  private readonly cancelled = new Set<string>();
  /** Trees that a request of this page cancels or removes; it may take effect after they have been asked for again. */
  private readonly ended = new Set<string>();

  constructor(
    catalogue: Pick<Catalogue, "onChange">,
    private readonly listener: GrowthListener,
  ) {
    catalogue.onChange((change) => this.hear(change));
  }

  /**
   * Finds these trees on the server, and asks for the others, one after the other. What is growing for former ones
   * goes on if it is among these, and is ended otherwise. `asks`: whether the visitor may be asked for the server's key.
   */
  async start(orders: readonly Order[], asks: boolean): Promise<void> {
    const batch: Batch = {
      orders: new Map(orders.map((order) => [textOf(order), order])),
      asked: new Map(),
      ready: new Map(),
      faults: new Map(),
    };
    this.replace(batch);
    try {
      await this.find(batch);
      await this.ask(batch, asks);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (this.batch === batch) this.end(batch, error);
    }
  }

  /** Ends what is growing; no end is told. */
  cancel(): void {
    this.replace(null);
  }

  private replace(batch: Batch | null): void {
    const before = this.batch;
    this.batch = batch;
    for (const [id, asked] of before?.asked ?? []) {
      if (before?.ready.has(asked.key)) continue;
      if (batch?.orders.has(asked.key)) batch.asked.set(id, asked);
      else this.endTree(id);
    }
    if (batch) this.tell(batch);
  }

  /** Notes the trees that are there already. */
  private async find(batch: Batch): Promise<void> {
    const orders = [...batch.orders];
    const { trees, cannot_grow } = await findIndividuals(orders.map(([, order]) => order));
    if (this.batch !== batch) return;
    orders.forEach(([key, order], k) => {
      const tree = trees[k];
      if (tree) batch.ready.set(key, individualOf(tree.id, order));
    });
    this.tell(batch);
    if (cannot_grow !== null && !isComplete(batch)) throw new CannotGrow(cannot_grow);
  }

  private async ask(batch: Batch, asks: boolean): Promise<void> {
    const known = new Set([...batch.asked.values()].map(({ key }) => key));
    const missing = [...batch.orders].filter(([key]) => !known.has(key) && !batch.ready.has(key));
    for (const [key, order] of missing) {
      if (this.batch !== batch) return;
      await this.askFor(batch, key, order, asks);
    }
    if (this.batch === batch) this.tell(batch);
  }

  private async askFor(batch: Batch, key: string, order: Order, asks: boolean): Promise<void> {
    const { id, job_id } = await growIndividual(order, asks);
    if (this.batch !== batch) {
      // the batch that has followed asks for it again, if it wants it
      if (!this.batch?.orders.has(key)) this.endTree(id);
      return;
    }
    this.ending.delete(id);
    if (this.removed.delete(id)) return this.askFor(batch, key, order, asks);
    batch.asked.set(id, { key, jobId: job_id });
    const change = this.heard.get(id);
    if (change) this.settle(batch, change);
  }

  /** Asks again for a tree that this page itself has ended, for a former batch. */
  private async askAgain(batch: Batch, key: string, order: Order): Promise<void> {
    try {
      await this.askFor(batch, key, order, false);
      if (this.batch === batch) this.tell(batch);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (this.batch === batch) this.end(batch, error);
    }
  }

  private hear(change: TreeChange): void {
    const { tree, deleted } = change;
    if (!tree.grown) return;
    this.removed.delete(tree.id);
    if (deleted) this.heard.delete(tree.id);
    else this.heard.set(tree.id, change);
    if (this.ending.has(tree.id)) this.endTree(tree.id);
    const { batch } = this;
    if (!batch?.asked.has(tree.id)) {
      if (!deleted) return;
      this.ended.delete(tree.id);
      this.removed.add(tree.id);
      return;
    }
    this.settle(batch, change);
    this.tell(batch);
  }

  /** Notes that a tree of the batch is there, or will not be. */
  private settle(batch: Batch, { tree, job, deleted }: TreeChange): void {
    const { orders, asked, ready, faults } = batch;
    const found = asked.get(tree.id);
    const order = orders.get(found?.key ?? "");
    if (!found || !order || ready.has(found.key) || (isActive(job) && !deleted)) return;
    if (tree.state === "ready" && !deleted) ready.set(found.key, individualOf(tree.id, order));
    else if (deleted || job?.id === found.jobId) {
      asked.delete(tree.id);
      if (this.ended.delete(tree.id)) void this.askAgain(batch, found.key, order);
      else faults.set(found.key, job?.error ?? "It was cancelled.");
    }
  }

  /** Tells how far a batch is, or that it is complete. */
  private tell(batch: Batch): void {
    if (isComplete(batch)) this.end(batch, null);
    else this.listener.progress(batch.ready.size + batch.faults.size, batch.orders.size);
  }

  private end(batch: Batch, problem: Problem | null): void {
    this.replace(null);
    const { orders, ready, faults } = batch;
    const trees = [...orders.keys()].flatMap((key) => ready.get(key) ?? []);
    this.listener.end({ trees, faults: [...faults.values()], problem });
  }

  /** Ends the growth of a tree and removes it; one that is there already stays, others may have planted it. */
  private endTree(id: string): void {
    this.ending.add(id);
    const change = this.heard.get(id);
    if (change && isActive(change.job)) {
      this.ended.add(id);
      if (this.cancelled.has(change.job.id)) return;
      this.cancelled.add(change.job.id);
      void this.quietly(cancelJob(change.job.id));
    } else if (change) {
      this.ending.delete(id);
      if (change.tree.state === "ready") return;
      this.ended.add(id);
      void this.quietly(deleteTree(id));
    }
  }

  /** The tree may have ended, or be gone, by itself. */
  private async quietly(request: Promise<void>): Promise<void> {
    try {
      await request;
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
    }
  }
}

const isComplete = ({ orders, ready, faults }: Batch): boolean => ready.size + faults.size === orders.size;
