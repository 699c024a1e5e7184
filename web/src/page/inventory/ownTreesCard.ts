/** Part of the inventory's card: how many trees are grown for its stems, what that costs, and how far it is. */

import { ProgressBar } from "../progress/progressBar";
import { make, makeButton, write } from "../ui/dom";

/** Most trees that are grown for one inventory: a server holds at most 64 tables in a forest. */
const MOST_TREES = 40;
const USUAL_TREES = 12;
/** Measured (docs/design/0036-individuals.md): time of one core; light mesh and table, whose pictures are there. */
const SECONDS_PER_TREE = 7;
const MEGABYTES_PER_TREE = 0.44;

export interface OwnTreesTools {
  grow(budget: number): void;
  cancel(): void;
  /** Back to the built-in trees. */
  leave(): void;
}

/** Which part is shown: the offer, the progress, or what was planted. */
export type OwnTreesState =
  | { readonly at: "offer"; readonly stems: number }
  | { readonly at: "growing"; readonly done: number; readonly all: number }
  | { readonly at: "planted"; readonly trees: number; readonly shown: number; readonly stems: number };

export class OwnTreesCard {
  readonly root = make("form", "", "own-trees");
  private readonly budget = make("input");
  private readonly label = make("label");
  private readonly words = make("p");
  private readonly bar = new ProgressBar("Growing own trees");
  private readonly grow = make("button", "Grow own trees");
  private readonly cancel: HTMLButtonElement;
  private readonly leave: HTMLButtonElement;
  private stems = 0;

  constructor(tools: OwnTreesTools) {
    const { root, budget, grow, label } = this;
    budget.type = "number";
    Object.assign(budget, { min: "1", max: String(MOST_TREES), step: "1", required: true });
    budget.value = String(USUAL_TREES);
    budget.addEventListener("input", () => this.sayCosts());
    label.append(make("span", "Trees"), budget);
    grow.type = "submit";
    this.cancel = makeButton("Cancel", () => tools.cancel());
    this.leave = makeButton("Use the built-in trees", () => tools.leave());
    root.addEventListener("submit", (event) => {
      event.preventDefault();
      tools.grow(budget.valueAsNumber);
    });
    this.words.setAttribute("role", "status");
    const row = make("div", "", "picked-tools");
    row.append(label, grow, this.cancel, this.leave);
    root.append(this.words, this.bar.root, row);
  }

  show(state: OwnTreesState): void {
    const { at } = state;
    this.label.hidden = this.grow.hidden = at !== "offer";
    this.bar.root.hidden = this.cancel.hidden = at !== "growing";
    this.leave.hidden = at !== "planted";
    if (at === "offer") {
      this.stems = state.stems;
      this.sayCosts();
    } else if (at === "growing") {
      this.bar.show(state.done / state.all);
      write(this.words, `Growing trees of their own: ${state.done} of ${state.all}`);
    } else {
      write(
        this.words,
        `${state.trees} trees of their own stand for ${state.shown} of ${state.stems} stems.`,
      );
    }
  }

  private sayCosts(): void {
    const { budget, stems } = this;
    if (!budget.validity.valid) {
      write(this.words, `Choose 1 to ${MOST_TREES} trees.`);
      return;
    }
    const trees = Math.min(budget.valueAsNumber, stems);
    write(
      this.words,
      "Two trees of each species stand for all stems. The server can grow more, each nearest in size to some stems: " +
        `${trees} trees take ${SECONDS_PER_TREE * trees} s of its processors, and ${(MEGABYTES_PER_TREE * trees).toFixed(1)} MB to load.`,
    );
  }
}
