/** The trees of the server, with meshes and tables as they are loaded. */

import type { TreeAsset } from "../../scene/forest";
import { readTreeModel } from "../../scene/trees/mesh/treeMesh";
import type { TableMotion } from "../../worker/protocol";
import { fetchMesh, followEvents, type Job, Problem, type Tree, type TreeChange } from "./api";

export interface CatalogueEvents {
  /** A tree or its job changed. */
  change(change: TreeChange): void;
  /** The assets of the forest changed: place the trees again. */
  assetsChanged(): void;
  /** The server has new records of the paper's method. */
  recordsChanged(): void;
  connected(connected: boolean): void;
  problem(title: string, hint: string): void;
}

/** A tree of the forest, its last job, and its table once that is loaded. */
export interface KnownTree {
  readonly tree: Tree;
  readonly job: Job | null;
  readonly motion: TableMotion | null;
}

interface Entry {
  tree: Tree;
  job: Job | null;
  readonly asset: TreeAsset;
  /** Hashes of the newest mesh and table, loaded or being loaded. */
  mesh: string | null;
  table: string | null;
  motion: TableMotion | null;
}

const knownTree = ({ tree, job, asset }: Entry): KnownTree => ({ tree, job, motion: asset.motion });

export class Catalogue {
  private readonly entries = new Map<string, Entry>();
  private readonly stop: () => void;

  constructor(
    private readonly loadTable: (sha256: string) => Promise<TableMotion>,
    private readonly events: CatalogueEvents,
  ) {
    this.stop = followEvents({
      change: (change) => this.receive(change),
      open: () => events.connected(true),
      lost: () => events.connected(false),
    });
  }

  get assets(): TreeAsset[] {
    return [...this.entries.values()].map((entry) => entry.asset);
  }

  /** Names of the trees that move. */
  get ready(): string[] {
    return [...this.entries.values()]
      .filter(({ asset }) => asset.motion)
      .map(({ tree }) => tree.species ?? tree.name);
  }

  /** Every tree of the forest, as last received from the server. */
  get trees(): Tree[] {
    return [...this.entries.values()].map(({ tree }) => tree);
  }

  get known(): KnownTree[] {
    return [...this.entries.values()].map(knownTree);
  }

  find(id: string): KnownTree | null {
    const entry = this.entries.get(id);
    return entry ? knownTree(entry) : null;
  }

  /** Number of trees whose motion is still being computed. */
  get waiting(): number {
    return [...this.entries.values()].filter(({ tree }) => tree.state === "building").length;
  }

  private receive(change: TreeChange): void {
    const { tree } = change;
    if (change.deleted || tree.state === "failed") this.remove(tree.id);
    else if (tree.state !== "uploaded") this.keep(change); // uploads join once they are submitted
    this.events.change(change);
  }

  private remove(id: string): void {
    if (this.entries.delete(id)) this.events.assetsChanged();
  }

  private keep({ tree, job }: TreeChange): void {
    let entry = this.entries.get(tree.id);
    if (!entry) {
      const asset: TreeAsset = { id: tree.id, species: tree.species, model: null, motion: null };
      entry = { tree, job, asset, mesh: null, table: null, motion: null };
      this.entries.set(tree.id, entry);
    }
    const recorded = (entry.tree.records_sha256 ?? null) !== (tree.records_sha256 ?? null);
    entry.tree = tree;
    entry.job = job;
    if (recorded) this.events.recordsChanged();
    void this.follow(entry).catch((error: unknown) => this.report(error));
  }

  /** Fetches new mesh and table in parallel; superseded responses are dropped. */
  private async follow(entry: Entry): Promise<void> {
    await Promise.all([this.takeMesh(entry), this.takeTable(entry)]);
  }

  private async takeMesh(entry: Entry): Promise<void> {
    const { mesh_sha256: mesh } = entry.tree;
    if (!mesh || mesh === entry.mesh) return;
    entry.mesh = mesh;
    const model = await readTreeModel(await fetchMesh(mesh));
    if (entry.mesh !== mesh) return;
    entry.asset.model = model;
    this.join(entry);
  }

  /** A full table may replace a preliminary one of the same mesh; the trees keep moving meanwhile. */
  private async takeTable(entry: Entry): Promise<void> {
    const { table_sha256: table } = entry.tree;
    if (!table || table === entry.table) return;
    entry.table = table;
    try {
      const motion = await this.loadTable(table);
      if (entry.table !== table) return;
      entry.motion = motion;
      this.join(entry);
    } catch (error) {
      if (entry.table === table) throw error;
    }
  }

  /** The trees move once mesh and table are loaded and match, and are static until then. */
  private join(entry: Entry): void {
    const { asset, motion, table } = entry;
    if (!asset.model || !this.entries.has(entry.tree.id)) return;
    const vertices = asset.model.parts.reduce((sum, part) => sum + part.vertices, 0);
    asset.motion = motion?.vertexNode.length === vertices ? motion : null;
    // A tree whose table is about to arrive is placed together with it.
    if (asset.motion || !table || motion) this.events.assetsChanged();
  }

  private report(error: unknown): void {
    if (error instanceof Problem) this.events.problem(error.title, error.hint);
    else
      this.events.problem(
        "A tree could not be displayed.",
        error instanceof Error ? error.message : String(error),
      );
  }

  dispose(): void {
    this.stop();
  }
}
