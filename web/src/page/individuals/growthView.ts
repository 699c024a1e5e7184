/** How far the forest's own trees are: words, progress, and what can be done about it. */

import { ProgressBar } from "../progress/progressBar";
import type { GrowthState } from "../store/store";
import { make, makeButton, write } from "../ui/dom";

/** Measured (docs/design/0036-individuals.md): time of one core; light mesh and table, whose pictures are there. */
const SECONDS_PER_TREE = 9;
const MEGABYTES_PER_TREE = 0.44;

export interface GrowthTools {
  cancel(): void;
  again(): void;
  /** Back to the built-in trees. */
  leave(): void;
}

/** What so many trees of their own cost. Pure. */
export const costsOf = (trees: number): string =>
  `${trees} trees take ${SECONDS_PER_TREE * trees} s of its processors, and ${(MEGABYTES_PER_TREE * trees).toFixed(1)} MB to load.`;

/** A state in words; `places`: what the trees stand for. Empty: nothing need be said. Pure. */
export function growthWords(state: GrowthState, places: string): string {
  if (state.at === "growing") return `Growing trees of their own: ${state.done} of ${state.all}`;
  if (state.at === "planted")
    return `${state.trees} trees of their own stand for ${state.shown} of ${state.all} ${places}.`;
  if (state.at === "none") return "";
  return `${state.title.replace(/\.$/, "")}. ${state.hint} The built-in trees stand for the others.`;
}

export class GrowthView {
  readonly words = make("p");
  readonly bar = new ProgressBar("Growing own trees");
  readonly buttons: readonly HTMLButtonElement[];
  private readonly cancel: HTMLButtonElement;
  private readonly again: HTMLButtonElement;
  private readonly leave: HTMLButtonElement;

  constructor(
    private readonly places: string,
    tools: GrowthTools,
  ) {
    this.words.setAttribute("role", "status");
    this.cancel = makeButton("Cancel", () => tools.cancel());
    this.again = makeButton("Try again", () => tools.again());
    this.leave = makeButton("Use the built-in trees", () => tools.leave());
    this.buttons = [this.cancel, this.again, this.leave];
  }

  show(state: GrowthState): void {
    const { at } = state;
    write(this.words, growthWords(state, this.places));
    this.bar.root.hidden = this.cancel.hidden = at !== "growing";
    if (at === "growing") this.bar.show(state.done / state.all);
    this.again.hidden = at !== "refused" || state.final;
    this.leave.hidden = at !== "planted" && at !== "refused";
  }
}
