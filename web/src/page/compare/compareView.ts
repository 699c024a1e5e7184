/** "Check accuracy": a dialog that overlays a tree animated from its table with the reference solution. */
import type { TableMotion } from "galewood/client";
import type { Method } from "galewood/motion";
import type { TreeModel } from "galewood/trees";
import type { WindState } from "galewood/wind";
import { MAX_FRAME_S } from "../forest/frameStatistics";
import { stiffnessInWords } from "../physics/physics";
import { Problem, type Tree } from "../server/api";
import { reportOf } from "../server/reports";
import { make } from "../ui/dom";
import { displayName } from "../ui/words";
import { ComparisonScene, FULL_RED_ERROR_SHARE, type Shown } from "./comparisonScene";
import { Curves } from "./curves";
import { compare } from "./request";
import type { Tracks } from "./tracks";
import { percent, verdictLines } from "./words";

/** A tree that can be compared, its table in leaf, and the place of one of its instances. */
export interface Candidate {
  readonly tree: Tree;
  readonly model: TreeModel;
  readonly motion: TableMotion;
  readonly place: { x_m: number; z_m: number; yaw_rad: number };
}

/** What the dialog needs from the page. */
export interface ComparePage {
  candidates(): Candidate[];
  /** The current wind and its time. */
  wind(): { state: WindState; time_s: number } | null;
  /** A comparison of this table has been computed. */
  compared(motion: TableMotion, tracks: Tracks): void;
  closed(): void;
}

const LOOP_S = 10;
const WORDS =
  "The solid tree is animated from its table, like every tree in the forest. The blue ghost is the reference solution: " +
  "a full finite element simulation in the current wind, computed on the server. Where they differ, the tree turns red. " +
  "Gusts may differ from branch to branch: the reference solution and the modal model feel this, the paper's method does not.";

export class CompareView {
  private readonly dialog = make("dialog", "", "compare");
  private readonly canvas = make("canvas", "", "compare-stage");
  private readonly choice = make("select");
  private method = make("select");
  private readonly status = make("p", "", "compare-status");
  private readonly bar = make("progress");
  private readonly verdict = make("p", "", "compare-verdict");
  private readonly again = make("button", "Repeat with the current wind");
  private readonly scene: ComparisonScene;
  private readonly curves: Curves;
  private readonly shown: Shown = { method: "modal", ghost: true, times: 1 };
  private tracks: Tracks | null = null;
  /** Whether the stiffness of the tree was chosen, in words. */
  private stiffness = "";
  private foliage: TableMotion["foliage"] = "leaf";
  private place = 0;
  private playing = true;
  private last_ms = 0;
  private running: AbortController | null = null;
  private frame = 0;

  constructor(private readonly page: ComparePage) {
    const paper = make("div", "", "compare-curves");
    this.compose(paper);
    document.body.append(this.dialog);
    this.scene = new ComparisonScene(this.canvas);
    this.curves = new Curves(paper, (time_s) => this.seek(time_s));
    this.dialog.addEventListener("close", () => {
      this.closed();
      this.page.closed();
    });
  }

  private compose(paper: HTMLElement): void {
    const heading = make("h2", "Check accuracy");
    heading.id = "compare-heading";
    this.dialog.setAttribute("aria-labelledby", heading.id);
    const close = make("button", "Close");
    close.type = "button";
    close.addEventListener("click", () => this.dialog.close());
    const head = make("header");
    head.append(heading, close);
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute(
      "aria-label",
      "The tree animated from its table, with the reference solution as a ghost",
    );
    this.status.setAttribute("role", "status");
    this.bar.setAttribute("aria-label", "Simulation");
    this.bar.max = 1;
    const side = make("section", "", "compare-side");
    side.append(this.controls(), this.status, this.bar, this.verdict, paper);
    const body = make("div", "", "compare-body");
    body.append(this.canvas, side);
    this.dialog.append(head, make("p", WORDS), body);
  }

  private controls(): HTMLElement {
    const row = make("div", "", "compare-controls");
    this.choice.addEventListener("change", () => void this.start());
    this.again.type = "button";
    this.again.addEventListener("click", () => void this.start());
    this.method = select({ modal: "Modal model", paper: "Paper's state search" }, (value) =>
      this.choose(value as Method),
    );
    const times = select({ 1: "1×", 3: "3×", 10: "10×" }, (value) => {
      this.shown.times = Number(value);
    });
    const ghost = make("input");
    ghost.type = "checkbox";
    ghost.checked = true;
    ghost.addEventListener("change", () => {
      this.shown.ghost = ghost.checked;
    });
    const pause = make("button", "Pause");
    pause.type = "button";
    pause.addEventListener("click", () => {
      this.playing = !this.playing;
      pause.textContent = this.playing ? "Pause" : "Play";
    });
    row.append(
      labelled("Tree", this.choice),
      labelled("Method", this.method),
      labelled("Motion scale", times),
      labelled("Show reference", ghost),
      pause,
      this.again,
    );
    return row;
  }

  /** Opens the dialog and starts a comparison; `treeId` is the tree to select first. */
  open(treeId: string | null): void {
    if (this.dialog.open) return;
    const candidates = this.page.candidates();
    this.choice.replaceChildren(
      ...candidates.map(({ tree }) => {
        const option = make("option", displayName(tree));
        option.value = tree.id;
        return option;
      }),
    );
    if (treeId && candidates.some(({ tree }) => tree.id === treeId)) this.choice.value = treeId;
    this.dialog.showModal();
    this.last_ms = performance.now();
    this.frame = requestAnimationFrame((now) => this.play(now));
    void this.start();
  }

  private async start(): Promise<void> {
    this.running?.abort();
    const chosen = this.page.candidates().find(({ tree }) => tree.id === this.choice.value);
    const wind = this.page.wind();
    if (!chosen || !wind) {
      this.showStatus("No tree has been computed yet. Try again when the first tree is moving.");
      return;
    }
    const running = new AbortController();
    this.running = running;
    this.tracks = null;
    this.verdict.textContent = "";
    this.scene.setTree(chosen.model, chosen.motion);
    this.foliage = chosen.motion.foliage;
    this.stiffness = "";
    void reportOf(chosen.tree).then((report) => {
      if (running.signal.aborted) return;
      this.stiffness = stiffnessInWords(report);
      this.showVerdict();
    });
    this.progress(0, "Requesting the reference solution");
    const frames = Math.round(LOOP_S * 30);
    const asked = { treeId: chosen.tree.id, wind: wind.state, start_s: wind.time_s, frames, ...chosen.place };
    try {
      const tracks = await compare(asked, { progress: (f, w) => this.progress(f, w) }, running.signal);
      if (tracks.modes !== chosen.motion.modes)
        throw new Problem("The table has changed.", "Repeat the comparison.");
      this.page.compared(chosen.motion, tracks);
      this.arrive(tracks);
    } catch (error) {
      if (!running.signal.aborted) this.fail(error);
    }
  }

  private choose(method: Method): void {
    this.shown.method = method;
    this.showVerdict();
  }

  /** The paper's method can be chosen once the table has records. */
  private offerMethods(tracks: Tracks): void {
    const missing = tracks.gusts.error.paper === null;
    for (const option of this.method.options) option.disabled = missing && option.value === "paper";
    if (!missing || this.shown.method === "modal") return;
    this.method.value = "modal";
    this.choose("modal");
  }

  private arrive(tracks: Tracks): void {
    this.tracks = tracks;
    this.offerMethods(tracks);
    this.place = 0;
    this.bar.hidden = true;
    this.curves.show(tracks);
    this.showVerdict();
  }

  private fail(error: unknown): void {
    if (error instanceof Problem) this.showStatus(`${error.title} ${error.hint}`);
    else this.showStatus(error instanceof Error ? error.message : String(error));
  }

  private showStatus(words: string): void {
    this.bar.hidden = true;
    this.status.textContent = words;
  }

  private progress(fraction: number, words: string): void {
    this.bar.hidden = false;
    this.bar.value = fraction;
    this.status.textContent = words;
  }

  /** Summarizes the result for the chosen method, first that of the motion on display. */
  private showVerdict(): void {
    if (!this.tracks) return;
    const { gusts, uniform } = this.tracks;
    const { method } = this.shown;
    this.verdict.replaceChildren(
      ...verdictLines(gusts, uniform, method).map((line) => make("span", line)),
      make("span", `Full red marks an error of ${percent(100 * FULL_RED_ERROR_SHARE)} %.`),
    );
    const foliage = this.foliage === "bare" ? "without leaves" : "in leaf";
    this.status.textContent = `Table ${foliage}; ${LOOP_S} s of this wind, starting from rest, in a loop. ${this.stiffness}`;
  }

  private seek(time_s: number): void {
    if (this.tracks) this.place = Math.max(0, time_s / this.tracks.dt_s - 1);
  }

  private play(now_ms: number): void {
    this.frame = requestAnimationFrame((now) => this.play(now));
    const passed_s = Math.min(MAX_FRAME_S, (now_ms - this.last_ms) / 1000);
    this.last_ms = now_ms;
    const { tracks } = this;
    if (tracks) {
      if (this.playing) this.place = (this.place + Math.max(0, passed_s) / tracks.dt_s) % tracks.frames;
      this.scene.show(tracks, this.place, this.shown);
      this.curves.at((this.place + 1) * tracks.dt_s);
    }
    this.scene.render();
  }

  private closed(): void {
    cancelAnimationFrame(this.frame);
    this.running?.abort();
    this.running = null;
  }
}

function labelled(words: string, control: HTMLElement): HTMLLabelElement {
  const label = make("label", words);
  label.append(control);
  return label;
}

function select(choices: Record<string, string>, chosen: (value: string) => void): HTMLSelectElement {
  const made = make("select");
  made.append(
    ...Object.entries(choices).map(([value, words]) => {
      const option = make("option", words);
      option.value = value;
      return option;
    }),
  );
  made.addEventListener("change", () => chosen(made.value));
  return made;
}
