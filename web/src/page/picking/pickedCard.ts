/** Card of the selected tree: its current motion, pictures of its model, and actions. */
import { effect } from "@preact/signals-core";
import type { PaperMethod } from "../paper/paperMethod";
import { onlyExtrasLeft, stateWords } from "../paper/paperState";
import { chosenStiffness } from "../physics/physics";
import { cancelJob, jobPictures, Problem, pictureUrl, type Tree } from "../server/api";
import type { Catalogue, KnownTree } from "../server/catalogue";
import { reportOf } from "../server/reports";
import { plantAs, plantedAs } from "../settings/planted";
import type { Store } from "../store/store";
import { element, make, makeButton, write } from "../ui/dom";
import { showToast } from "../ui/toast";
import { displayName, whole } from "../ui/words";
import { PlantedChoice } from "./plantedChoice";
import type { PickedFigures, TreePicker } from "./treePicker";

/** What other features offer for the selected tree. */
export interface CardParts {
  /** The choice of what is drawn on it. */
  readonly menu: HTMLElement;
  /** The wind risk of a stem of an inventory. */
  readonly stem: HTMLElement;
  readonly buttons: readonly HTMLElement[];
}

const PICTURES = { "tetrahedra.png": "Tetrahedra", "skeleton.png": "Skeleton" } as const;

/** The figures as rows of label and value; `loading`: whether its table is being fetched. Pure. */
export function figuresInWords(
  { moves, height_m, tip_m, extrapolationRatio, record }: PickedFigures,
  loading = false,
): [string, string][] {
  const rows: [string, string][] = [["Height", `${height_m.toFixed(1)} m`]];
  if (!moves) return [...rows, ["Motion", loading ? "loading" : "not computed yet"]];
  rows.push(["Tip displacement", `${tip_m.toFixed(2)} m`]);
  rows.push(["Relative to height", `${((100 * tip_m) / height_m).toFixed(1)} %`]);
  if (extrapolationRatio !== null) {
    const beyond = extrapolationRatio > 1 ? " (extrapolated)" : "";
    rows.push(["Extrapolation ratio", `${extrapolationRatio.toFixed(2)}${beyond}`]);
  }
  if (record !== null) rows.push(["Current record", whole(record)]);
  return rows;
}

/** Cancels a computation; says why if that fails. */
async function cancel(jobId: string): Promise<void> {
  try {
    await cancelJob(jobId);
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    showToast(error.title, error.hint);
  }
}

export class PickedCard {
  private readonly root = make("article", "", "card picked");
  private readonly heading = make("h2");
  private readonly list = make("dl");
  private readonly words = make("span");
  private readonly cancel = makeButton("Cancel", () => void cancel(this.jobId), "picked-cancel");
  private readonly pictures = make("div", "", "job-pictures");
  private readonly planted: PlantedChoice;
  private shownId = "";
  /** The state of the tree whose report was asked for, and the last report that has arrived. */
  private reportedAt = "";
  private buildReport: unknown = null;
  private jobId = "";

  constructor(
    private readonly store: Store,
    private readonly picker: TreePicker,
    private readonly catalogue: Catalogue,
    private readonly paper: PaperMethod,
    { menu, stem, buttons }: CardParts,
  ) {
    this.root.hidden = true;
    this.root.setAttribute("aria-label", "Selected tree");
    const { following } = picker;
    const follow = makeButton("Follow", () => {
      following.value = !following.value;
    });
    effect(() => follow.setAttribute("aria-pressed", String(following.value)));
    const close = makeButton("✕", () => picker.select(null));
    close.setAttribute("aria-label", "Close");
    const row = make("div", "", "picked-tools");
    row.append(follow, ...buttons, close);
    const state = make("p", "", "picked-state");
    state.append(this.words, this.cancel);
    this.planted = new PlantedChoice((how) => plantAs(store.settings, this.shownId, how));
    this.root.append(this.heading, this.list, state, this.planted.root, stem, menu, this.pictures, row);
    element("progress").before(this.root);
    effect(() => this.report());
  }

  /** Shows the current figures of the picked tree; without one the card is hidden. */
  report(): void {
    const { figures } = this.picker;
    const known = figures && this.catalogue.find(figures.treeId);
    this.root.hidden = !known;
    if (figures && known) this.show(figures, known);
    else this.shownId = "";
  }

  private show(figures: PickedFigures, known: KnownTree): void {
    const { tree } = known;
    if (this.shownId !== tree.id) {
      this.shownId = tree.id;
      this.heading.textContent = displayName(tree);
      this.reportedAt = "";
      this.buildReport = null;
      void this.showPictures(tree);
    }
    const figured = figuresInWords(figures, Boolean(tree.table_sha256));
    const stiffness = chosenStiffness(this.reportFor(tree));
    if (stiffness) figured.push(["Stiffness", `× ${Number(stiffness.factor.toPrecision(2))} of its wood`]);
    const rows = figured.map(([name, value]) => {
      const row = make("div");
      row.append(make("dt", name), make("dd", value));
      return row;
    });
    this.list.replaceChildren(...rows);
    this.planted.root.hidden = tree.builtin || tree.grown === true;
    this.planted.show(plantedAs(this.store.settings, tree.id));
    this.showState(known);
  }

  /** The report of the shown tree; until it arrives, that before its last change, or null. */
  private reportFor(tree: Tree): unknown {
    const { updated_at } = tree;
    if (this.reportedAt !== updated_at) {
      this.reportedAt = updated_at;
      void reportOf(tree).then((report) => {
        if (this.shownId === tree.id && this.reportedAt === updated_at) this.buildReport = report;
      });
    }
    return this.buildReport;
  }

  private showState(known: KnownTree): void {
    const { job } = known;
    const cancellable = onlyExtrasLeft(job);
    this.jobId = cancellable ? job.id : "";
    const what = job?.stage === "bare" ? "table without leaves" : "paper's method";
    this.cancel.setAttribute("aria-label", `Cancel the computation of the ${what}`);
    this.cancel.hidden = !cancellable;
    write(this.words, stateWords(known, this.paper.stateOf(known)));
  }

  private async showPictures(tree: Tree): Promise<void> {
    this.pictures.replaceChildren();
    const none: Record<string, string> = {};
    const found = tree.job_id ? await jobPictures(tree.job_id).catch(() => none) : none;
    if (this.shownId !== tree.id || !tree.job_id) return;
    // The tree may have been deselected and selected again before the response arrived: show one set of pictures.
    this.pictures.replaceChildren();
    for (const [name, sha256] of Object.entries(found)) {
      if (!(name in PICTURES)) continue;
      const link = make("a");
      const image = make("img");
      link.href = image.src = pictureUrl(tree.job_id, name, sha256);
      link.target = "_blank";
      image.alt = `${PICTURES[name as keyof typeof PICTURES]} of ${displayName(tree)}`;
      link.append(image);
      this.pictures.append(link);
    }
  }
}
