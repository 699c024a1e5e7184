/** The trees of the server, with meshes and tables as they are loaded. */

import type { TreeAsset } from "../../scene/forest";
import { readTreeModel } from "../../scene/trees/mesh/treeMesh";
import type { TableMotion } from "../../worker/protocol";
import { fetchMesh, followEvents, Problem, type Tree, type TreeChange } from "./api";

export interface CatalogueEvents {
  /** A tree or its job changed. */
  change(change: TreeChange): void;
  /** The assets of the forest changed: place the trees again. */
  assetsChanged(): void;
  connected(connected: boolean): void;
  problem(title: string, hint: string): void;
}

interface Entry {
  tree: Tree;
  readonly asset: TreeAsset;
  /** Hashes of the newest mesh and table, loaded or being loaded. */
  mesh: string | null;
  table: string | null;
  motion: TableMotion | null;
}

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

  /** Size of a tree's table in bytes; null until it is loaded. */
  tableBytes(id: string): number | null {
    return this.entries.get(id)?.asset.motion?.bytes ?? null;
  }

  /** Number of trees whose motion is still being computed. */
  get waiting(): number {
    return [...this.entries.values()].filter(({ tree }) => tree.state === "building").length;
  }

  private receive(change: TreeChange): void {
    const { tree } = change;
    if (change.deleted || tree.state === "failed") this.remove(tree.id);
    else if (tree.state !== "uploaded") this.keep(tree); // uploads join once they are submitted
    this.events.change(change);
  }

  private remove(id: string): void {
    if (this.entries.delete(id)) this.events.assetsChanged();
  }

  private keep(tree: Tree): void {
    let entry = this.entries.get(tree.id);
    if (!entry) {
      const asset: TreeAsset = { id: tree.id, species: tree.species, model: null, motion: null };
      entry = { tree, asset, mesh: null, table: null, motion: null };
      this.entries.set(tree.id, entry);
    }
    entry.tree = tree;
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
