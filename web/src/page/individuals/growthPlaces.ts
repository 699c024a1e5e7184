/** Where the page shows how far the own trees of the generated forest are: below their slider, and on a card while they grow. */

import { effect } from "@preact/signals-core";
import type { BladeApi } from "tweakpane";
import type { Store } from "../store/store";
import { element, make, write } from "../ui/dom";
import { type GrowthTools, GrowthView } from "./growthView";

const NO_SERVER_WORDS = "Own trees are grown by the server, which is not connected.";

function partsOf(view: GrowthView): HTMLElement[] {
  const row = make("div", "", "picked-tools");
  row.append(...view.buttons);
  return [view.words, view.bar.root, row];
}

/** Adds the state of the own trees to their slider, which is hidden while it could do nothing. */
export function followSlider(slider: BladeApi, { state }: Pick<Store, "state">, tools: GrowthTools): void {
  const view = new GrowthView("trees", tools);
  const root = make("div", "", "own-trees-state");
  root.append(...partsOf(view));
  slider.element.after(root);
  effect(() => {
    const { growth, connected } = state;
    const lost = !connected && (growth.at === "none" || growth.at === "refused");
    const final = growth.at === "refused" && growth.final;
    view.show(lost ? { at: "none" } : growth);
    if (lost) write(view.words, NO_SERVER_WORDS);
    slider.hidden = lost || final;
    root.hidden = !lost && growth.at === "none";
  });
}

/** Makes the card, which is shown while trees grow for the generated forest; an inventory's card shows its own. */
export function makeGrowthCard({ state }: Pick<Store, "state">, tools: GrowthTools): void {
  const view = new GrowthView("trees", tools);
  const root = make("article", "", "card growth");
  root.setAttribute("aria-label", "Own trees");
  root.append(make("h2", "Own trees"), ...partsOf(view));
  element("cards").prepend(root);
  effect(() => {
    const { growth, inventory } = state;
    root.hidden = growth.at !== "growing" || inventory !== null;
    view.show(growth);
  });
}
