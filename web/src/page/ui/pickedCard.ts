/** Card of the selected tree: its current motion, pictures of its model, and actions. */
import { onlyExtrasLeft, type PaperState, stateWords } from "../paper/paperState";
import { jobPictures, pictureUrl, type Tree } from "../server/api";
import type { KnownTree } from "../server/catalogue";
import { reportOf } from "../server/reports";
import type { Planted } from "../settings/planted";
import type { PickedFigures } from "../treePicker";
import { element, make } from "./dom";
import { chosenStiffness } from "./physics";
import { PlantedChoice } from "./plantedChoice";
import { displayName } from "./words";

export interface PickedTools {
  follow(following: boolean): void;
  compare(): void;
  physics(): void;
  /** Ends the computation of this job. */
  cancel(jobId: string): void;
  /** How an upload is planted; `plant` changes it. */
  planted(id: string): Planted | null;
  plant(id: string, how: Planted | null): void;
  close(): void;
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
  if (record !== null) rows.push(["Current record", record.toLocaleString("en")]);
  return rows;
}

export class PickedCard {
  private readonly root = make("article", "", "card picked");
  private readonly heading = make("h2");
  private readonly list = make("dl");
  private readonly words = make("span");
  private readonly cancel = make("button", "Cancel", "picked-cancel");
  private readonly pictures = make("div", "", "job-pictures");
  private readonly follow = make("button", "Follow");
  private readonly planted: PlantedChoice;
  private shownId = "";
  /** The state of the tree whose report was asked for, and the last report that has arrived. */
  private reportedAt = "";
  private report: unknown = null;
  private jobId = "";

  /** `overlays` is the menu of what to draw on the tree. */
  constructor(
    private readonly tools: PickedTools,
    overlays: HTMLElement,
  ) {
    this.root.hidden = true;
    this.root.setAttribute("aria-label", "Selected tree");
    const row = make("div", "", "picked-tools");
    this.follow.setAttribute("aria-pressed", "false");
    this.follow.addEventListener("click", () => {
      const on = this.follow.getAttribute("aria-pressed") !== "true";
      this.follow.setAttribute("aria-pressed", String(on));
      tools.follow(on);
    });
    const button = (words: string, pressed: () => void) => {
      const made = make("button", words);
      made.addEventListener("click", pressed);
      return made;
    };
    const close = button("✕", () => tools.close());
    close.setAttribute("aria-label", "Close");
    row.append(
      this.follow,
      button("Check accuracy", () => tools.compare()),
      button("Physics", () => tools.physics()),
      close,
    );
    this.cancel.addEventListener("click", () => tools.cancel(this.jobId));
    const state = make("p", "", "picked-state");
    state.append(this.words, this.cancel);
    this.planted = new PlantedChoice((how) => tools.plant(this.shownId, how));
    this.root.append(this.heading, this.list, state, this.planted.root, overlays, this.pictures, row);
    for (const made of [this.cancel, ...row.querySelectorAll("button")]) made.type = "button";
    element("progress").before(this.root);
  }

  /** Shows the current figures of the tree; null hides the card. */
  show(figures: PickedFigures | null, known: KnownTree | null, paper: PaperState): void {
    this.root.hidden = !figures || !known;
    if (!figures || !known) {
      this.shownId = "";
      this.follow.setAttribute("aria-pressed", "false");
      return;
    }
    const { tree } = known;
    if (this.shownId !== tree.id) {
      this.shownId = tree.id;
      this.heading.textContent = displayName(tree);
      this.reportedAt = "";
      this.report = null;
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
    this.planted.root.hidden = tree.builtin;
    this.planted.show(this.tools.planted(tree.id));
    this.showState(known, paper);
  }

  /** The report of the shown tree; until it arrives, that before its last change, or null. */
  private reportFor(tree: Tree): unknown {
    const { updated_at } = tree;
    if (this.reportedAt !== updated_at) {
      this.reportedAt = updated_at;
      void reportOf(tree).then((report) => {
        if (this.shownId === tree.id && this.reportedAt === updated_at) this.report = report;
      });
    }
    return this.report;
  }

  private showState(known: KnownTree, paper: PaperState): void {
    const words = stateWords(known, paper);
    const { job } = known;
    const cancellable = onlyExtrasLeft(job);
    this.jobId = cancellable ? job.id : "";
    const what = job?.stage === "bare" ? "table without leaves" : "paper's method";
    this.cancel.setAttribute("aria-label", `Cancel the computation of the ${what}`);
    this.cancel.hidden = !cancellable;
    if (this.words.textContent !== words) this.words.textContent = words;
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

  dispose(): void {
    this.root.remove();
  }
}
