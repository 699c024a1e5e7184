/** The paper's method on this page: fetches the records when it is chosen, and knows which trees use it. */

import type { KnownTree } from "../server/catalogue";
import type { Settings } from "../settings/settings";
import { isRecorded, type PaperState, paperNote, paperStateOf, recordsFileOf } from "./paperState";

export interface PaperPage {
  /** Trees of the forest. */
  trees(): readonly KnownTree[];
  /** Loads a records file for a loaded table. */
  load(table: string, records: string): Promise<void>;
  /** Records have arrived: place the trees again. */
  arrived(): void;
  problem(title: string, hint: string): void;
}

export class PaperMethod {
  /** Records files by the hash of their table. */
  private readonly files = new Map<string, "loading" | "loaded" | "failed">();

  constructor(
    private readonly settings: Pick<Settings, "method" | "lookup">,
    private readonly page: PaperPage,
  ) {}

  /** Fetches what is missing; call when the trees or the place of computation change. */
  update(): void {
    const { method, lookup } = this.settings;
    if (method !== "paper" || lookup !== "worker") return;
    for (const known of this.page.trees()) {
      const file = recordsFileOf(known);
      if (file && !this.files.has(file.table)) void this.fetch(file.table, file.records);
    }
  }

  /** The visitor chose a method: files that failed are fetched again. */
  chosen(): void {
    for (const [table, state] of this.files) if (state === "failed") this.files.delete(table);
    this.update();
  }

  private async fetch(table: string, records: string): Promise<void> {
    this.files.set(table, "loading");
    try {
      await this.page.load(table, records);
      this.files.set(table, "loaded");
      if (this.settings.method === "paper") this.page.arrived();
    } catch (error) {
      this.files.set(table, "failed");
      const reason = error instanceof Error ? error.message : String(error);
      this.page.problem("The records of the paper's method could not be loaded.", reason);
    }
  }

  stateOf(known: KnownTree): PaperState {
    const loading = known.motion !== null && this.files.get(known.motion.sha256) === "loading";
    return paperStateOf(known, loading);
  }

  /** Whether the trees of a kind move by the paper's method. */
  moves(known: KnownTree): boolean {
    const { method, lookup } = this.settings;
    if (method !== "paper" || !known.motion) return false;
    if (lookup === "worker")
      return known.motion.hasRecords || this.files.get(known.motion.sha256) === "loaded";
    return this.page.trees().every((other) => !other.motion || isRecorded(other));
  }

  /** What keeps trees from using the chosen method; empty if nothing does. */
  get note(): string {
    if (this.settings.method !== "paper") return "";
    const moving = this.page.trees().filter(({ motion }) => motion);
    return paperNote(moving.map((known) => ({ known, state: this.stateOf(known) })));
  }
}
