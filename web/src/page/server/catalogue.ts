/** The trees of the server, with meshes and tables as they are loaded. */

import { signal } from "@preact/signals-core";
import type { TableMotion } from "galewood/client";
import type { Foliage } from "galewood/core";
import type { TreeModel } from "galewood/trees";
import { EDGE_VIEW, type Viewpoint } from "../../scene/camera/viewpoints";
import { firstInView, type TreeAsset } from "../../scene/forest";
import type { BuiltinTree } from "../../scene/forestIndividuals";
import { type Grown, kindOf, kindsOf } from "../../scene/forms";
import type { ForestClient } from "../forest/forestClient";
import type { NamedInventory } from "../inventory/namedInventory";
import { plantedAs } from "../settings/planted";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { showToast } from "../ui/toast";
import { displayName } from "../ui/words";
import { fetchModel, type Job, Problem, type Tree, type TreeChange } from "./api";
import { type EventStream, followEvents } from "./eventStream";
import { LoadingOrder } from "./loadingOrder";

/** A tree of the forest, its last job, and the table that moves it once that is loaded. */
export interface KnownTree {
  readonly tree: Tree;
  readonly job: Job | null;
  readonly motion: TableMotion | null;
}

/** A table: the hash of the newest one, loaded or being loaded, and the loaded one. */
interface Slot {
  sha256: string | null;
  motion: TableMotion | null;
}

interface Entry {
  tree: Tree;
  job: Job | null;
  readonly asset: TreeAsset;
  /** Hash of the newest mesh, loaded or being loaded. */
  mesh: string | null;
  readonly leaf: Slot;
  /** The table without leaves, which is loaded when it is first wanted. */
  readonly bare: Slot;
}

/** Whether a tree has the name of a species in the inventory. */
const isNamedIn = (inventory: NamedInventory, tree: Tree): boolean =>
  [tree.id, displayName(tree)].some((name) => inventory.names.has(name.toLowerCase()));

const emptySlot = (): Slot => ({ sha256: null, motion: null });

const hasTable = ({ mesh_sha256, table_sha256 }: Tree) => Boolean(mesh_sha256 && table_sha256);

const toGrown = ({ id, species, builtin, form }: Tree): Grown => ({
  id,
  species,
  builtin,
  form: form ?? "open",
});

const assetOf = (tree: Tree): TreeAsset => ({
  ...toGrown(tree),
  hasTable: hasTable(tree),
  model: null,
  motion: null,
});

/** Whether a table moves the vertices of a model. */
function fits(motion: TableMotion | null, model: TreeModel | null): boolean {
  const vertices = model?.parts.reduce((sum, part) => sum + part.vertices, 0);
  return motion !== null && motion.vertexNode.length === vertices;
}

/** The view that a link names, or the usual one. */
const viewOf = ({ eye, target }: Store["opened"]): Viewpoint =>
  eye && target
    ? { eye: { x: eye[0], y: eye[1], z: eye[2] }, target: { x: target[0], y: target[1], z: target[2] } }
    : EDGE_VIEW;

const knownTree = ({ tree, job, asset }: Entry): KnownTree => ({ tree, job, motion: asset.motion });

export class Catalogue {
  /** Number of changes of the forest's assets, after each of which the trees are placed again. */
  readonly assetChanges = signal(0);
  /** Number of times that the server had new records of the paper's method. */
  readonly recordChanges = signal(0);
  readonly order = new LoadingOrder(() => this.firstSeen());
  /** Whether trees move by their tables without leaves; those that have none keep the other. */
  private bareWanted: boolean;
  private opened = false;
  private readonly entries = new Map<string, Entry>();
  private readonly listeners: ((change: TreeChange) => void)[] = [];
  /** The last change of each tree, for those who listen later. */
  private readonly heard = new Map<string, TreeChange>();
  private readonly stream: EventStream;

  constructor(
    private readonly store: Store,
    private readonly client: Pick<ForestClient, "loadTable">,
  ) {
    const { settings, state } = store;
    if (state.share !== null) this.order.loadAll();
    watch(
      () => [state.treesSeen, state.share, state.inventory],
      () => this.order.loadAll(),
    );
    this.bareWanted = this.wantsBare;
    watch(
      () => [this.wantsBare],
      ([bare]) => this.chooseFoliage(bare),
    );
    watch(
      () => [settings.planted, settings.shares, state.inventory, state.individuals],
      () => this.takePlanted(),
    );
    this.stream = followEvents({
      change: (change) => this.receive(change),
      open: () => {
        this.opened = true;
        state.connected = true;
      },
      lost: () => {
        state.connected = false;
      },
    });
  }

  /** Calls `listener` with the last change of each tree, and when a tree or its job has changed on the server. */
  onChange(listener: (change: TreeChange) => void): void {
    for (const change of this.heard.values()) listener(change);
    this.listeners.push(listener);
  }

  /** The built-in trees that are in the mix, the planted uploads, and the trees grown for this forest. */
  private get grown(): Entry[] {
    const { builtin } = this;
    return [...this.entries.values()].filter((entry) => this.isGrown(entry, builtin));
  }

  /** Other uploads are listed but not loaded. */
  private isGrown({ tree }: Entry, builtin = this.builtin): boolean {
    const { settings, state } = this.store;
    const inventory = state.inventory === "loading" ? null : state.inventory;
    if (tree.grown) return state.individuals.some(({ id }) => id === tree.id);
    if (tree.builtin) return inventory ? this.standsFor(inventory, tree) : this.isInMix(tree, builtin);
    return plantedAs(settings, tree.id) !== null || (inventory !== null && isNamedIn(inventory, tree));
  }

  /** Whether trees of this built-in species are planted in the forest. */
  private isInMix(tree: Tree, builtin: readonly Grown[]): boolean {
    const kind = kindOf(toGrown(tree), builtin);
    return (this.store.settings.shares[kind] ?? 1) > 0;
  }

  /** Whether a built-in tree stands for stems of an inventory; the first one does for species that this server lacks. */
  private standsFor({ builtin }: NamedInventory, tree: Tree): boolean {
    if (builtin.has(tree.species ?? "")) return true;
    const served = new Set(this.builtin.map(({ species }) => species));
    return tree.species === this.builtin[0]?.species && [...builtin].some((species) => !served.has(species));
  }

  private get builtin(): Grown[] {
    return [...this.entries.values()].flatMap(({ tree }) => (tree.builtin ? [toGrown(tree)] : []));
  }

  /** The trees of this forest, individuals last and in the order of the forest, which all who share it have in common. */
  get assets(): TreeAsset[] {
    const rank = new Map(this.store.state.individuals.map(({ id }, k) => [id, k]));
    const assets = this.grown.map((entry) => entry.asset);
    return assets.sort((a, b) => (rank.get(a.id) ?? -1) - (rank.get(b.id) ?? -1));
  }

  /** The built-in trees with their heights, also those that are not in the mix. */
  get builtinTrees(): BuiltinTree[] {
    return [...this.entries.values()].flatMap(({ tree }) => {
      const { builtin, species, height_m } = tree;
      return builtin && species && height_m ? [{ ...toGrown(tree), species, height_m }] : [];
    });
  }

  /** Whether the mesh and the table of every tree that has them are loaded. */
  get isLoaded(): boolean {
    return this.grown.every(
      ({ asset, leaf }) => !asset.hasTable || (asset.model !== null && leaf.motion !== null),
    );
  }

  /** Names of the trees that move. */
  get ready(): string[] {
    return this.grown.filter(({ asset }) => asset.motion).map(({ tree }) => tree.species ?? tree.name);
  }

  /** The built-in species with their forms: id and name of each. */
  get kinds(): { id: string; name: string }[] {
    return kindsOf(this.builtin).flatMap(({ id, open, forest }) => {
      const entry = this.entries.get((open ?? forest)?.id ?? "");
      return entry ? [{ id, name: displayName(entry.tree) }] : [];
    });
  }

  /** All uploads on the server, planted or not; trees that it has grown are none. */
  get uploads(): { id: string; name: string }[] {
    const uploads = [...this.entries.values()].filter(({ tree }) => !tree.builtin && !tree.grown);
    return uploads.map(({ tree }) => ({ id: tree.id, name: displayName(tree) }));
  }

  /** The upload with this name or id; null if there is none. */
  uploadNamed(name: string): string | null {
    const wanted = name.trim().toLowerCase();
    const found = this.uploads.find((tree) => tree.id === name || tree.name.toLowerCase() === wanted);
    return found?.id ?? null;
  }

  /** The trees of this forest, as last received from the server. */
  get known(): KnownTree[] {
    return this.grown.map(knownTree);
  }

  find(id: string): KnownTree | null {
    const entry = this.entries.get(id);
    return entry ? knownTree(entry) : null;
  }

  /** The table in leaf of a tree, which analyses refer to in every season; null until it is loaded. */
  leafMotion(id: string): TableMotion | null {
    const entry = this.entries.get(id);
    return entry && fits(entry.leaf.motion, entry.asset.model) ? entry.leaf.motion : null;
  }

  /** The server moves a shared forest by the tables in leaf, because its clients may look at it in any season. */
  private get wantsBare(): boolean {
    const { settings, state } = this.store;
    return settings.season === "winter" && (state.share === null || settings.lookup === "worker");
  }

  /** Whether trees are seen, and move, in leaf or bare. */
  get foliage(): Foliage {
    return this.bareWanted ? "bare" : "leaf";
  }

  private chooseFoliage(bare: boolean): void {
    this.bareWanted = bare;
    const entries = this.grown;
    for (const entry of entries) {
      void this.takeBareTable(entry).catch((error: unknown) => this.report(error));
    }
    if (entries.filter((entry) => this.chooseMotion(entry)).length > 0) this.assetChanges.value++;
  }

  /** Loads the trees that were not planted before. */
  private takePlanted(): void {
    for (const entry of this.grown) {
      this.chooseMotion(entry);
      void this.follow(entry).catch((error: unknown) => this.failed(entry, error));
    }
  }

  /** What is known of the server's trees, and what is still missing. */
  get listed() {
    const entries = [...this.grown];
    return {
      known: this.opened || entries.length > 0,
      computing: entries.filter(({ tree }) => tree.state === "building").length,
      loading: entries.filter(({ asset, leaf }) => asset.hasTable && !(asset.model && leaf.motion)).length,
    };
  }

  private receive(change: TreeChange): void {
    const { tree } = change;
    // Uploads join once they are submitted; one without a table leaves when its computation is cancelled.
    if (change.deleted || tree.state === "failed" || tree.state === "uploaded") this.remove(tree.id);
    else this.keep(change);
    if (change.deleted) this.heard.delete(tree.id);
    else this.heard.set(tree.id, change);
    for (const notify of this.listeners) notify(change);
  }

  private remove(id: string): void {
    if (this.entries.delete(id)) this.assetChanges.value++;
  }

  private keep({ tree, job }: TreeChange): void {
    let entry = this.entries.get(tree.id);
    if (!entry) {
      entry = { tree, job, asset: assetOf(tree), mesh: null, leaf: emptySlot(), bare: emptySlot() };
      this.entries.set(tree.id, entry);
    }
    const { asset } = entry;
    const hadTable = asset.hasTable;
    asset.hasTable = hasTable(tree);
    const recorded = (entry.tree.records_sha256 ?? null) !== (tree.records_sha256 ?? null);
    entry.tree = tree;
    entry.job = job;
    if (!this.isGrown(entry)) return;
    if (recorded) this.recordChanges.value++;
    // The other form of its species may stand in for a tree without a table.
    if (hadTable && !asset.hasTable) this.assetChanges.value++;
    void this.follow(entry).catch((error: unknown) => this.failed(entry, error));
  }

  /** The tree in the middle of the first picture. */
  private firstSeen(): TreeAsset | null {
    const { assets } = this;
    const { settings, opened } = this.store;
    const { trees, forestSeed } = settings;
    return firstInView(assets, trees, forestSeed, settings, viewOf(opened)) ?? assets[0] ?? null;
  }

  /** Fetches new mesh and table in parallel; superseded responses are dropped. */
  private async follow(entry: Entry): Promise<void> {
    if (this.order.awaitsFirst && hasTable(entry.tree)) await this.order.turnOf(entry.asset);
    await Promise.all([this.takeMesh(entry), this.takeTable(entry), this.takeBareTable(entry)]);
  }

  private async takeMesh(entry: Entry): Promise<void> {
    const { mesh_sha256: mesh } = entry.tree;
    if (!mesh || mesh === entry.mesh) return;
    entry.mesh = mesh;
    const { builtin, grown = false, evergreen } = entry.tree;
    const kind = { varied: builtin || grown, evergreen };
    const model = await fetchModel(mesh, kind, () => this.order.meshArrived());
    if (entry.mesh !== mesh) return;
    entry.asset.model = model;
    this.join(entry);
  }

  /** A full table may replace a preliminary one of the same mesh; the trees keep moving meanwhile. */
  private async takeTable(entry: Entry): Promise<void> {
    const { table_sha256: table } = entry.tree;
    if (table) await this.fill(entry, entry.leaf, table);
  }

  /** The trees keep moving by the table in leaf until the one without leaves is loaded. */
  private async takeBareTable(entry: Entry): Promise<void> {
    const { bare, tree } = entry;
    const table = tree.bare_table_sha256 ?? null;
    if (bare.sha256 !== null && bare.sha256 !== table) {
      Object.assign(bare, emptySlot());
      if (this.chooseMotion(entry)) this.assetChanges.value++;
    }
    if (table && this.bareWanted) await this.fill(entry, bare, table);
  }

  private async fill(entry: Entry, slot: Slot, table: string): Promise<void> {
    if (slot.sha256 === table) return;
    slot.sha256 = table;
    try {
      const motion = await this.client.loadTable(table);
      if (slot.sha256 !== table) return;
      slot.motion = motion;
      this.join(entry);
    } catch (error) {
      if (slot.sha256 !== table) return;
      if (slot === entry.bare) slot.sha256 = null; // tried again next winter
      throw error;
    }
  }

  /** The trees move once mesh and table are loaded and match, and are static until then. */
  private join(entry: Entry): void {
    const { asset, leaf } = entry;
    if (!asset.model || !this.entries.has(entry.tree.id)) return;
    this.chooseMotion(entry);
    // A tree whose table is about to arrive is placed together with it.
    if (asset.motion || !leaf.sha256 || leaf.motion) this.assetChanges.value++;
  }

  /** The table that moves a tree in this season; returns whether it is another one than before. */
  private chooseMotion({ asset, leaf, bare }: Entry): boolean {
    const before = asset.motion;
    const wanted =
      this.bareWanted && bare.motion?.meshSha256 === leaf.motion?.meshSha256 ? bare.motion : null;
    asset.motion = [wanted, leaf.motion].find((motion) => fits(motion, asset.model)) ?? null;
    return asset.motion !== before;
  }

  /** Of a tree that cannot be loaded the other form is planted, if there is one. */
  private failed({ asset, leaf }: Entry, error: unknown): void {
    this.report(error);
    this.order.loadAll();
    if (asset.model && leaf.motion) return;
    asset.hasTable = false;
    this.assetChanges.value++;
  }

  private report(error: unknown): void {
    if (error instanceof Problem) showToast(error.title, error.hint);
    else showToast("A tree could not be displayed.", error instanceof Error ? error.message : String(error));
  }

  /** Connects to the server at once if the connection is lost. */
  retry(): void {
    this.stream.retry();
  }

  dispose(): void {
    this.order.loadAll();
    this.stream.close();
  }
}
