/** Part of the inventory's card: how many trees are grown for its stems, what that costs, and how far it is. */

import { effect } from "@preact/signals-core";
import { MOST_OWN_TREES } from "../../scene/individuals";
import { costsOf, type GrowthTools, GrowthView } from "../individuals/growthView";
import type { Store } from "../store/store";
import { make, write } from "../ui/dom";

const USUAL_TREES = 12;

export interface OwnTreesTools extends Omit<GrowthTools, "again"> {
  grow(number: number): void;
}

export class OwnTreesCard {
  readonly root = make("form", "", "own-trees");
  private readonly view: GrowthView;
  private readonly number = make("input");
  private readonly label = make("label");
  private readonly growButton = make("button", "Grow own trees");

  constructor(
    private readonly store: Pick<Store, "settings" | "state">,
    tools: OwnTreesTools,
  ) {
    const { root, number, growButton, label } = this;
    number.type = "number";
    Object.assign(number, { min: "1", max: String(MOST_OWN_TREES), step: "1", required: true });
    number.value = String(store.settings.ownTrees || USUAL_TREES);
    number.addEventListener("input", () => this.sayCosts());
    label.append(make("span", "Trees"), number);
    growButton.type = "submit";
    const grow = () => tools.grow(number.valueAsNumber);
    root.addEventListener("submit", (event) => {
      event.preventDefault();
      grow();
    });
    this.view = new GrowthView("stems", { ...tools, again: grow });
    const row = make("div", "", "picked-tools");
    row.append(label, growButton, ...this.view.buttons);
    root.append(this.view.words, this.view.bar.root, row);
    effect(() => this.show());
  }

  private show(): void {
    const { state } = this.store;
    const { inventory, growth, connected } = state;
    // without a server nothing can be grown
    this.root.hidden = inventory === null || inventory === "loading" || !connected;
    this.view.show(growth);
    this.label.hidden = this.growButton.hidden = growth.at !== "none";
    if (growth.at === "none") this.sayCosts();
  }

  private sayCosts(): void {
    const { number, store } = this;
    const { inventory } = store.state;
    if (inventory === null || inventory === "loading") return;
    const { words } = this.view;
    if (!number.validity.valid) write(words, `Choose 1 to ${MOST_OWN_TREES} trees.`);
    else {
      const trees = Math.min(number.valueAsNumber, inventory.stems.length);
      const offer =
        "Two trees of each species stand for all stems. The server can grow more, each nearest in size to some stems:";
      write(words, `${offer} ${costsOf(trees)}`);
    }
  }
}
