/** Has the server grow trees for the stems of an inventory, and plants them when all are there. */

import type { Individual, Order } from "../../scene/individuals";
import { nearestIndividual, treesToGrow } from "../../scene/individuals";
import { cancelJob, deleteTree, growIndividual, isActive, Problem, type TreeChange } from "../server/api";
import type { Catalogue } from "../server/catalogue";
import { withServer } from "../server/connected";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { showToast } from "../ui/toast";
import { OwnTreesCard } from "./ownTreesCard";

/** A tree that was asked for, and the job that makes or has made it. */
interface Asked {
  readonly order: Order;
  readonly jobId: string | null;
}

/** Trees that were asked for together, by their ids on the server. */
interface Batch {
  readonly orders: readonly Order[];
  readonly asked: Map<string, Asked>;
  readonly ready: Map<string, Individual>;
  /** Why trees could not be grown. */
  readonly faults: string[];
}

const individualOf = (id: string, { species, form, height_m, dbh_cm }: Order): Individual => ({
  id,
  species,
  form,
  height_m,
  dbh_cm,
});

export class OwnTreesOfStems {
  private readonly card: OwnTreesCard;
  private batch: Batch | null = null;
  /** The last change of each tree that a server has grown. */
  private readonly heard = new Map<string, TreeChange>();
  /** Trees whose growth is being ended. */
  private readonly ending = new Set<string>();

  constructor(
    private readonly store: Store,
    catalogue: Pick<Catalogue, "onChange">,
    place: HTMLElement,
  ) {
    const { state } = store;
    this.card = new OwnTreesCard({
      grow: (budget) => void withServer("No trees are grown.", () => this.grow(budget)),
      cancel: () => this.cancel(),
      leave: () => {
        state.individuals = [];
      },
    });
    place.append(this.card.root);
    catalogue.onChange((change) => this.hear(change));
    watch(
      () => [state.inventory],
      () => {
        this.cancel();
        state.individuals = [];
      },
    );
    watch(
      () => [state.inventory, state.individuals, state.connected, state.share, store.settings.form],
      () => this.show(),
    );
    this.show();
  }

  private show(): void {
    const { settings, state } = this.store;
    const { inventory, individuals, connected, share } = state;
    const { batch, card } = this;
    // without a server nothing can be grown; in a shared forest the others would not have these trees
    card.root.hidden = inventory === null || inventory === "loading" || !connected || share !== null;
    if (inventory === null || inventory === "loading") return;
    const stems = inventory.stems.length;
    if (batch) {
      const done = batch.ready.size + batch.faults.length;
      card.show({ at: "growing", done, all: batch.orders.length });
    } else if (individuals.length > 0) {
      const nearest = nearestIndividual(individuals, settings.form);
      const shown = inventory.stems.filter((stem) => nearest(stem) !== null).length;
      card.show({ at: "planted", trees: individuals.length, shown, stems });
    } else card.show({ at: "offer", stems });
  }

  /** Asks for the trees one after the other. Throws a Problem; then nothing stays asked for. */
  private async grow(budget: number): Promise<void> {
    const { state, settings } = this.store;
    const { inventory } = state;
    if (this.batch || inventory === null || inventory === "loading" || !Number.isInteger(budget)) return;
    const orders = treesToGrow(inventory.stems, budget, settings.form);
    const batch: Batch = { orders, asked: new Map(), ready: new Map(), faults: [] };
    this.batch = batch;
    this.show();
    try {
      for (const order of orders) {
        const { id, job_id } = await growIndividual({ ...order, nearest_size: true });
        if (this.batch !== batch) {
          this.end(id);
          return;
        }
        this.ending.delete(id);
        batch.asked.set(id, { order, jobId: job_id });
        const change = this.heard.get(id);
        if (change) this.settle(batch, change);
      }
      this.finish(batch);
    } catch (error) {
      if (this.batch === batch) this.cancel();
      throw error;
    }
  }

  private hear(change: TreeChange): void {
    const { tree, job, deleted } = change;
    if (!tree.grown) return;
    if (deleted) this.heard.delete(tree.id);
    else this.heard.set(tree.id, change);
    if (this.ending.has(tree.id)) this.end(tree.id);
    const { batch } = this;
    if (!batch?.asked.has(tree.id)) return;
    this.settle(batch, { tree, job, deleted });
    this.finish(batch);
  }

  /** Notes that a tree of the batch is there, or will not be. */
  private settle({ asked, ready, faults }: Batch, { tree, job, deleted }: TreeChange): void {
    const found = asked.get(tree.id);
    if (!found || ready.has(tree.id) || (isActive(job) && !deleted)) return;
    if (tree.state === "ready" && !deleted) ready.set(tree.id, individualOf(tree.id, found.order));
    else if (deleted || job?.id === found.jobId) {
      asked.delete(tree.id);
      faults.push(job?.error ?? "It was cancelled.");
    }
  }

  /** Plants the trees of a batch once the last one is there. */
  private finish(batch: Batch): void {
    const { orders, ready, faults } = batch;
    if (ready.size + faults.length === orders.length) {
      this.batch = null;
      this.store.state.individuals = [...ready.values()];
      if (faults.length > 0) {
        showToast(`${faults.length} of ${orders.length} trees could not be grown.`, faults[0]);
      }
    }
    this.show();
  }

  private cancel(): void {
    const { batch } = this;
    this.batch = null;
    for (const id of batch?.asked.keys() ?? []) if (!batch?.ready.has(id)) this.end(id);
    this.show();
  }

  /** Ends the growth of a tree and removes it; one that is there already stays, others may have planted it. */
  private end(id: string): void {
    this.ending.add(id);
    const change = this.heard.get(id);
    if (change && isActive(change.job)) void this.quietly(cancelJob(change.job.id));
    else if (change) {
      this.ending.delete(id);
      if (change.tree.state !== "ready") void this.quietly(deleteTree(id));
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
