/** The visitor's uploads in the forest: plants them, marks them while they are computed, leads their owner to them. */

import type { Views } from "../camera/views";
import type { World } from "../forest/world";
import { onlyExtrasLeft } from "../paper/paperState";
import type { ProgressTools } from "../progress/progressCards";
import { cancelJob, deleteTree, isActive, Problem, startBuild, type TreeChange } from "../server/api";
import type { Catalogue } from "../server/catalogue";
import { plantAs, plantedAs } from "../settings/planted";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { prefersCalm } from "../ui/dom";
import { showToast } from "../ui/toast";
import { displayName } from "../ui/words";
import type { OwnUploads } from "./ownUploads";
import { TreeMark } from "./treeMark";

export class OwnTrees implements ProgressTools {
  private readonly marks = new Map<string, TreeMark>();
  /** Uploads whose computation ends, and whether a tree that moves is removed, too. */
  private readonly ending = new Map<string, boolean>();
  /** Jobs that the server was asked to end. */
  private readonly asked = new Set<string>();

  constructor(
    private readonly uploads: OwnUploads,
    private readonly store: Store,
    private readonly world: World,
    private readonly catalogue: Catalogue,
    private readonly views: Views,
  ) {
    const { settings, state } = store;
    uploads.onAdded = (id) => this.added(id);
    uploads.onCancel = (id, whole) => this.cancel(id, whole);
    catalogue.onChange((change) => this.changed(change));
    watch(
      () => [world.placements.value],
      () => this.appeared(),
    );
    watch(
      () => [settings.planted],
      ([now], [before]) => {
        if (state.share !== null) return;
        for (const id of Object.keys({ ...before, ...now }))
          if (now[id] !== before[id]) uploads.change(id, { planted: now[id] ?? null });
      },
    );
  }

  isOwn(id: string): boolean {
    return this.uploads.find(id)?.started === true;
  }

  isPlanted(id: string): boolean {
    return plantedAs(this.store.settings, id) !== null;
  }

  private added(id: string): void {
    const { settings, state } = this.store;
    if (state.share === null) {
      const how = plantedAs(settings, id) ?? "one";
      this.uploads.change(id, { planted: how });
      plantAs(settings, id, how);
      return;
    }
    showToast(
      "This forest is shared",
      "Your tree is computed but not planted. To plant it for everyone here, press “Plant more” on its card.",
      "good",
    );
  }

  plantMore(id: string): void {
    const { settings } = this.store;
    plantAs(settings, id, plantedAs(settings, id) === null ? "one" : "more");
  }

  /** A tree or its job changed on the server. */
  private changed(change: TreeChange): void {
    const { tree, deleted } = change;
    this.uploads.notify(tree.id, change);
    if (this.ending.has(tree.id)) this.end(change);
    const { settings } = this.store;
    if (deleted && (this.uploads.find(tree.id) || tree.id in settings.planted)) {
      this.uploads.forget(tree.id);
      plantAs(settings, tree.id, null);
    }
    this.mark(change);
  }

  /** The trees of a plan have appeared. */
  private appeared(): void {
    for (const id of Object.keys(this.store.settings.planted)) {
      const known = this.catalogue.find(id);
      if (known) this.mark({ tree: known.tree, job: known.job });
      const tree = this.world.forest.last(id);
      if (tree?.moves && this.uploads.find(id)?.shown === false) this.lead(id);
    }
  }

  /** The first motion of an upload: takes its owner there, unless that would take the camera out of their hands. */
  private lead(id: string): void {
    this.uploads.change(id, { shown: true });
    this.uploads.notify(id, null);
    const known = this.catalogue.find(id);
    if (!prefersCalm() && !this.views.isBusy) this.show(id);
    else if (known)
      showToast(`${displayName(known.tree)} moves`, "Press “Show my tree” to go there.", "good");
  }

  /** Moves the camera to an upload. */
  show(id: string): void {
    const tree = this.world.forest.last(id);
    if (tree) this.views.showTree({ ...tree.position, height_m: tree.height_m });
  }

  private mark({ tree, job, deleted }: TreeChange): void {
    const { id } = tree;
    const planted = this.world.forest.last(id);
    const tableMissing: boolean = !deleted && !onlyExtrasLeft(job);
    if (!planted || planted.moves || !tableMissing || !isActive(job) || !this.isPlanted(id)) {
      this.marks.get(id)?.dispose();
      this.marks.delete(id);
      return;
    }
    const mark = this.marks.get(id) ?? new TreeMark(this.world.stage);
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

  /** Ends the computation. A tree that does not move yet is removed, another one keeps its motion unless `whole`. */
  cancel(id: string, whole = false): void {
    this.ending.set(id, whole);
    const known = this.catalogue.find(id);
    if (known && isActive(known.job)) this.end(known); // otherwise once the server has announced the job
  }

  private end({ tree, job, deleted }: TreeChange): void {
    const cancelled = job?.state === "cancelled";
    if (isActive(job)) {
      if (!this.asked.has(job.id)) this.request(cancelJob(job.id));
      this.asked.add(job.id);
      return;
    }
    const whole = this.ending.get(tree.id) === true;
    this.ending.delete(tree.id);
    if (cancelled && !deleted && (whole || tree.table_sha256 === null)) this.request(deleteTree(tree.id));
  }

  again(id: string): void {
    this.request(startBuild(id));
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
}
