/** The visitor's uploads in the forest: plants them, marks them while they are computed, leads their owner to them. */
import type { Forest } from "../../scene/forest";
import type { Stage } from "../../scene/stage";
import { onlyExtrasLeft } from "../paper/paperState";
import { cancelJob, deleteTree, isActive, Problem, startPrecompute, type TreeChange } from "../server/api";
import type { Catalogue } from "../server/catalogue";
import { type Planted, plantAs, plantedAs } from "../settings/planted";
import type { Settings } from "../settings/settings";
import type { ProgressTools } from "../ui/progress";
import { showToast } from "../ui/toast";
import { displayName } from "../ui/words";
import type { Visit } from "../visit";
import { Attention } from "./attention";
import type { OwnUploads } from "./ownUploads";
import { TreeMark } from "./treeMark";

export interface OwnTreesPage {
  readonly settings: Settings;
  readonly stage: Stage;
  readonly forest: Forest;
  readonly catalogue: Catalogue;
  readonly visit: Visit;
  /** Whether the forest is shared with others now, so that what is planted here is planted for all. */
  isShared(): boolean;
  /** The choice of planted trees changed: place the trees again, and remember it. */
  replant(): void;
  /** An upload has appeared in the forest. */
  planted(id: string): void;
}

const isCalm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

export class OwnTrees implements ProgressTools {
  private readonly marks = new Map<string, TreeMark>();
  private readonly attention: Attention;
  /** Trees whose computation is being ended. */
  private readonly ending = new Set<string>();
  /** Jobs that the server was asked to end. */
  private readonly asked = new Set<string>();

  constructor(
    private readonly uploads: OwnUploads,
    private readonly page: OwnTreesPage,
  ) {
    this.attention = new Attention(page.stage.renderer.domElement);
    uploads.onAdded = (id) => this.added(id);
    uploads.onCancel = (id) => this.cancel(id);
  }

  isOwn(id: string): boolean {
    return this.uploads.find(id)?.started === true;
  }

  isPlanted(id: string): boolean {
    return plantedAs(this.page.settings, id) !== null;
  }

  private added(id: string): void {
    if (!this.page.isShared()) {
      this.plant(id, plantedAs(this.page.settings, id) ?? "one");
      return;
    }
    showToast(
      "This forest is shared",
      "Your tree is computed but not planted. To plant it for everyone here, press “Plant more” on its card.",
      "good",
    );
  }

  /** Changes how an upload is planted; null removes it from the forest, but not from the server. */
  plant(id: string, how: Planted | null): void {
    plantAs(this.page.settings, id, how);
    if (!this.page.isShared()) this.uploads.change(id, { planted: how });
    this.page.replant();
  }

  plantMore(id: string): void {
    const before = plantedAs(this.page.settings, id);
    this.plant(id, before === null ? "one" : "more");
  }

  /** A tree or its job changed on the server. */
  changed(change: TreeChange): void {
    const { tree, deleted } = change;
    this.uploads.tell(tree.id, change);
    if (this.ending.has(tree.id)) this.end(change);
    if (deleted && (this.uploads.find(tree.id) || tree.id in this.page.settings.planted)) {
      this.uploads.forget(tree.id);
      this.plant(tree.id, null);
    }
    this.mark(change);
  }

  /** The trees of a plan have appeared. */
  appeared(): void {
    for (const id of Object.keys(this.page.settings.planted)) {
      const known = this.page.catalogue.find(id);
      if (known) this.mark({ tree: known.tree, job: known.job });
      const tree = this.page.forest.last(id);
      if (!tree) continue;
      this.page.planted(id);
      if (tree.moves && this.uploads.find(id)?.shown === false) this.lead(id);
    }
  }

  /** The first motion of an upload: takes its owner there, unless that would take the camera out of their hands. */
  private lead(id: string): void {
    this.uploads.change(id, { shown: true });
    this.uploads.tell(id, null);
    const known = this.page.catalogue.find(id);
    if (!isCalm() && !this.attention.isBusy && !this.page.visit.isBusy) this.show(id);
    else if (known)
      showToast(`${displayName(known.tree)} moves`, "Press “Show my tree” to go there.", "good");
  }

  /** Moves the camera to an upload. */
  show(id: string): void {
    const tree = this.page.forest.last(id);
    if (tree) this.page.visit.showTree({ ...tree.position, height_m: tree.height_m });
  }

  private mark({ tree, job, deleted }: TreeChange): void {
    const { id } = tree;
    const planted = this.page.forest.last(id);
    const tableMissing: boolean = !deleted && !onlyExtrasLeft(job);
    if (!planted || planted.moves || !tableMissing || !isActive(job) || !this.isPlanted(id)) {
      this.marks.get(id)?.dispose();
      this.marks.delete(id);
      return;
    }
    const mark = this.marks.get(id) ?? new TreeMark(this.page.stage);
    this.marks.set(id, mark);
    const percent = Math.round(100 * job.fraction);
    mark.show(
      planted,
      `${displayName(tree)}, ${job.state === "queued" ? "queued" : `${percent} %`}`,
      job.fraction,
    );
  }

  /** Per frame. */
  advance(): void {
    for (const mark of this.marks.values()) mark.advance();
  }

  /** Ends the computation. A tree that does not move yet is removed, another one keeps its motion. */
  cancel(id: string): void {
    this.ending.add(id);
    const known = this.page.catalogue.find(id);
    if (known && isActive(known.job)) this.end(known); // otherwise once the server has announced the job
  }

  private end({ tree, job, deleted }: TreeChange): void {
    const cancelled = job?.state === "cancelled";
    if (isActive(job)) {
      if (!this.asked.has(job.id)) this.request(cancelJob(job.id));
      this.asked.add(job.id);
      return;
    }
    this.ending.delete(tree.id);
    if (cancelled && !deleted && tree.table_sha256 === null) this.request(deleteTree(tree.id));
  }

  again(id: string): void {
    this.request(startPrecompute(id));
  }

  remove(id: string): void {
    this.request(deleteTree(id));
  }

  private request(answer: Promise<unknown>): void {
    answer.catch((error: unknown) => {
      if (!(error instanceof Problem)) throw error;
      showToast(error.title, error.hint);
    });
  }

  dispose(): void {
    this.uploads.onAdded = null;
    this.uploads.onCancel = null;
    for (const mark of this.marks.values()) mark.dispose();
    this.attention.dispose();
  }
}
