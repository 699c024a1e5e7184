/** Imports and computes all trees of a file, each as an upload of its own, and shows the progress of each. */
import { ProgressBar } from "../progress/progressBar";
import { faultOf } from "../progress/progressCards";
import {
  type BuildSettings,
  changeAssumptions,
  copyTree,
  deleteTree,
  isActive,
  Problem,
  type ReportedTree,
  startBuild,
  type Tree,
  type TreeChange,
} from "../server/api";
import { make } from "../ui/dom";
import type { OwnUploads } from "../uploads/ownUploads";
import type { Assumed, FoundTree } from "./assumed";

/** The name of each tree: its own in the file, or that of the upload with its number. Pure. */
export function namesOf(upload: string, trees: readonly FoundTree[]): string[] {
  const twice = new Set(trees.map(({ name }) => name).filter((name, k, all) => all.indexOf(name) !== k));
  return trees.map(({ name, number }) =>
    name && !twice.has(name) ? `${upload}, ${name}` : `${upload} ${number}`,
  );
}

/** The height to ask for: trees of one file have one unit, also if it is not that of the file. Pure. */
export const heightOf = ({ unit }: Assumed, { height_m }: FoundTree): number | null =>
  unit === "given" || unit === "unknown" ? height_m : null;

type State = "waiting" | "importing" | "computing" | "moving" | "failed" | "left";

class Entry {
  readonly root = make("li");
  state: State = "waiting";
  tree: Tree | null = null;
  private readonly line = make("small", "Waiting");
  private readonly bar: ProgressBar;
  private readonly cancel = make("button", "Cancel");

  constructor(
    readonly found: FoundTree,
    readonly name: string,
    cancelled: () => void,
  ) {
    this.bar = new ProgressBar(name);
    this.line.setAttribute("role", "status");
    Object.assign(this.cancel, { type: "button" });
    this.cancel.setAttribute("aria-label", `Cancel ${name}`);
    this.cancel.addEventListener("click", cancelled);
    const about = make("span", "", "own-tree-about");
    about.append(make("span", `${name}, ${found.height_m.toFixed(1)} m`), this.bar.root, this.line);
    this.root.append(about, this.cancel);
  }

  get isOver(): boolean {
    return this.state === "moving" || this.state === "failed" || this.state === "left";
  }

  show(state: State, words: string, share = 0): void {
    this.state = state;
    this.line.textContent = words;
    this.bar.show(state === "moving" ? 1 : share);
    this.root.classList.toggle("failed", state === "failed");
    this.cancel.hidden = this.isOver;
  }
}

export interface SeveralHost {
  /** The upload whose file has the trees, and what was detected in it. */
  readonly tree: Tree;
  readonly assumed: Assumed;
  /** Chosen for the tree that is shown; the service chooses the stiffness of the others. */
  readonly settings: BuildSettings;
  readonly uploads: OwnUploads;
}

export class SeveralTrees {
  readonly root = make("div", "", "own-tree-several");
  private readonly entries: readonly Entry[];
  private readonly stops: (() => void)[] = [];
  private running = true;

  /** `leave` closes the dialog; the rest goes on. `finished` is called when no tree is left to wait for. */
  constructor(
    private readonly host: SeveralHost,
    leave: () => void,
    private readonly finished: () => void,
  ) {
    const { tree, assumed } = host;
    const names = namesOf(tree.name, assumed.trees);
    this.entries = assumed.trees.map((found, k) => {
      const entry: Entry = new Entry(found, names[k], () => this.cancel(entry));
      return entry;
    });
    const list = make("ul");
    list.append(...this.entries.map(({ root }) => root));
    const all = make("button", "Cancel all");
    const go = make("button", "Continue in the forest", "primary");
    for (const button of [all, go]) button.type = "button";
    all.addEventListener("click", () => {
      for (const entry of this.entries) if (!entry.isOver) this.cancel(entry);
    });
    go.addEventListener("click", leave);
    const foot = make("footer");
    foot.append(all, go);
    this.root.append(make("p", `Importing ${this.entries.length} trees`), list, foot);
  }

  /** Imports one tree after the other; a failure stops none of the others. The shown tree is the first. */
  async run(): Promise<void> {
    const order = [...this.entries].sort((a, b) => Number(b.found.taken) - Number(a.found.taken));
    for (const entry of order) if (entry.state === "waiting") await this.import(entry);
    this.running = false;
    const [shown] = order; // the others were copied from it
    if (shown.state === "left" || !this.isPlanted(shown)) await this.remove(shown);
  }

  private async import(entry: Entry): Promise<void> {
    entry.show("importing", "Reading the mesh on the server");
    try {
      const tree = await this.treeOf(entry);
      entry.tree = tree;
      if (this.wasLeft(entry)) {
        if (!entry.found.taken) await deleteTree(tree.id);
        return;
      }
      if (tree.state === "uploaded" || tree.state === "failed")
        await startBuild(tree.id, entry.found.taken ? this.host.settings : {});
      this.follow(entry, tree);
      if (this.wasLeft(entry) && !entry.found.taken) await this.remove(entry);
    } catch (error) {
      if (!this.wasLeft(entry)) entry.show("failed", faultWords(error));
      if (!entry.found.taken && !this.isPlanted(entry)) await this.remove(entry);
      this.notify();
    }
  }

  /** Whether its computation was started, and its progress is shown with the forest. */
  private isPlanted({ tree }: Entry): boolean {
    return tree !== null && this.host.uploads.find(tree.id) !== null;
  }

  /** Not the narrowed type: a tree may be cancelled while it is imported. */
  private wasLeft(entry: Entry): boolean {
    return entry.state === "left";
  }

  private treeOf({ found, name }: Entry): Promise<ReportedTree> {
    const { tree, assumed } = this.host;
    if (found.taken) return changeAssumptions(tree.id, { name });
    return copyTree(tree.id, { name, tree: found.number, height_m: heightOf(assumed, found) });
  }

  private follow(entry: Entry, tree: Tree): void {
    const { uploads } = this.host;
    if (this.wasLeft(entry)) entry.show("left", "Cancelled");
    else if (tree.table_sha256 === null) entry.show("computing", "Computing its motion");
    else entry.show("moving", "It moves already");
    this.stops.push(uploads.watch(tree.id, (change) => this.changed(entry, change)));
    uploads.add(tree.id, true);
    // the camera goes to one of them only
    if (!entry.found.taken) uploads.change(tree.id, { shown: true });
  }

  private changed(entry: Entry, change: TreeChange | null): void {
    if (entry.isOver) return;
    const job = change?.job ?? null;
    if (change === null || change.tree.table_sha256 !== null) entry.show("moving", "It moves");
    else if (job?.state === "failed") entry.show("failed", faultOf(job));
    else if (isActive(job)) {
      const words =
        job.state === "queued" ? "Waiting in the queue" : `Computing, ${Math.round(100 * job.fraction)} %`;
      entry.show("computing", words, job.fraction);
    }
    this.notify();
  }

  private cancel(entry: Entry): void {
    const { state } = entry;
    entry.show("left", "Cancelled");
    if (state === "computing" && !(entry.found.taken && this.running)) void this.remove(entry);
    this.notify();
  }

  /** Removes an upload that was cancelled, and ends its computation. */
  private async remove({ tree, found }: Entry): Promise<void> {
    const id = tree?.id ?? (found.taken ? this.host.tree.id : null);
    if (id === null) return;
    if (this.host.uploads.find(id)) this.host.uploads.onCancel?.(id, true);
    else await deleteTree(id).catch(() => {});
  }

  private notify(): void {
    if (this.entries.every(({ isOver }) => isOver)) this.finished();
  }

  dispose(): void {
    for (const stop of this.stops) stop();
  }
}

const faultWords = (error: unknown): string => {
  if (error instanceof Problem) return `${error.title} ${error.hint}`;
  return error instanceof Error ? error.message : String(error);
};
