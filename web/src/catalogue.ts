/** Which trees the server has, and their meshes and tables as they come in. */
import { fetchMesh, followEvents, Problem, type Tree, type TreeChange } from "./api";
import type { Grower } from "./scene/forest";
import { readTreeModel } from "./scene/treeMesh";
import type { TableMotion } from "./worker/protocol";

export interface CatalogueEvents {
  /** A tree or its job changed. */
  change(change: TreeChange): void;
  /** The growers changed: plant anew. */
  grow(): void;
  connected(connected: boolean): void;
  problem(title: string, hint: string): void;
}

interface Entry {
  tree: Tree;
  readonly grower: Grower;
  mesh: string | null;
  table: string | null;
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

  get growers(): Grower[] {
    return [...this.entries.values()].map((entry) => entry.grower);
  }

  /** Names of the trees that sway. */
  get ready(): string[] {
    return [...this.entries.values()]
      .filter(({ grower }) => grower.motion)
      .map(({ tree }) => tree.species ?? tree.name);
  }

  /** Every tree of the forest, as the server last told. */
  get trees(): Tree[] {
    return [...this.entries.values()].map(({ tree }) => tree);
  }

  /** Bytes of a tree's table, null while it is not here. */
  tableBytes(id: string): number | null {
    return this.entries.get(id)?.grower.motion?.bytes ?? null;
  }

  /** Trees whose motion is still to come. */
  get waiting(): number {
    return [...this.entries.values()].filter(({ tree }) => tree.state === "building").length;
  }

  private receive(change: TreeChange): void {
    const { tree } = change;
    if (change.deleted || tree.state === "failed") this.remove(tree.id);
    else if (tree.state !== "uploaded") this.keep(tree); // one that nobody has asked to compute is no part of the forest
    this.events.change(change);
  }

  private remove(id: string): void {
    if (this.entries.delete(id)) this.events.grow();
  }

  private keep(tree: Tree): void {
    let entry = this.entries.get(tree.id);
    if (!entry) {
      const grower: Grower = { id: tree.id, species: tree.species, model: null, motion: null };
      entry = { tree, grower, mesh: null, table: null };
      this.entries.set(tree.id, entry);
    }
    entry.tree = tree;
    void this.follow(entry).catch((error: unknown) => this.report(error));
  }

  /** Fetches what is new. The mesh goes first: it can stand while its table is on the way. */
  private async follow(entry: Entry): Promise<void> {
    const { mesh_sha256: mesh, table_sha256: table } = entry.tree;
    const newTable = table !== entry.table ? table : null;
    entry.table = table;
    const motion = newTable ? this.loadTable(newTable) : null;
    if (mesh && mesh !== entry.mesh) {
      entry.mesh = mesh;
      entry.grower.motion = null;
      entry.grower.model = await readTreeModel(await fetchMesh(mesh));
      if (!motion) this.events.grow();
    }
    if (motion) {
      entry.grower.motion = await motion;
      this.events.grow();
    }
  }

  private report(error: unknown): void {
    if (error instanceof Problem) this.events.problem(error.title, error.hint);
    else
      this.events.problem(
        "A tree could not be shown.",
        error instanceof Error ? error.message : String(error),
      );
  }

  dispose(): void {
    this.stop();
  }
}
