/** The paper's method on this page: fetches the records when it is chosen, and knows which trees use it. */

import { signal } from "@preact/signals-core";
import type { ForestClient } from "../forest/forestClient";
import type { Catalogue, KnownTree } from "../server/catalogue";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { showToast } from "../ui/toast";
import { isRecorded, type PaperState, paperNote, paperStateOf, recordsFileOf } from "./paperState";

export class PaperMethod {
  /** Number of times that records have arrived which the trees of this forest can use. */
  readonly arrivals = signal(0);
  /** Records files by the hash of their table. */
  private readonly files = new Map<string, "loading" | "loaded" | "failed">();

  constructor(
    private readonly store: Store,
    private readonly catalogue: Pick<Catalogue, "known" | "assetChanges" | "recordChanges">,
    private readonly client: Pick<ForestClient, "loadRecords">,
  ) {
    const { settings } = store;
    watch(
      () => [settings.method, settings.lookup],
      () => this.chosen(),
    );
    watch(
      () => [catalogue.assetChanges.value],
      () => this.update(),
    );
    watch(
      () => [catalogue.recordChanges.value],
      () => {
        this.update();
        if (settings.method === "paper" && settings.lookup === "server") this.arrivals.value++;
      },
    );
    this.update();
  }

  /** Fetches what is missing. */
  private update(): void {
    const { method, lookup } = this.store.settings;
    if (method !== "paper" || lookup !== "worker") return;
    for (const known of this.catalogue.known) {
      const file = recordsFileOf(known);
      if (file && !this.files.has(file.table)) void this.fetch(file.table, file.records);
    }
  }

  /** The visitor chose a method: files that failed are fetched again. */
  private chosen(): void {
    for (const [table, state] of this.files) if (state === "failed") this.files.delete(table);
    this.update();
  }

  private async fetch(table: string, records: string): Promise<void> {
    this.files.set(table, "loading");
    try {
      await this.client.loadRecords(table, records);
      this.files.set(table, "loaded");
      if (this.store.settings.method === "paper") this.arrivals.value++;
    } catch (error) {
      this.files.set(table, "failed");
      const reason = error instanceof Error ? error.message : String(error);
      showToast("The records of the paper's method could not be loaded.", reason);
    }
  }

  stateOf(known: KnownTree): PaperState {
    const loading = known.motion !== null && this.files.get(known.motion.sha256) === "loading";
    return paperStateOf(known, loading);
  }

  /** Whether the trees of a kind move by the paper's method. */
  moves(known: KnownTree): boolean {
    const { method, lookup } = this.store.settings;
    if (method !== "paper" || !known.motion) return false;
    if (lookup === "worker")
      return known.motion.hasRecords || this.files.get(known.motion.sha256) === "loaded";
    return this.catalogue.known.every((other) => !other.motion || isRecorded(other));
  }

  /** What keeps trees from using the chosen method; empty if nothing does. */
  get note(): string {
    if (this.store.settings.method !== "paper") return "";
    const moving = this.catalogue.known.filter(({ motion }) => motion);
    return paperNote(moving.map((known) => ({ known, state: this.stateOf(known) })));
  }
}
