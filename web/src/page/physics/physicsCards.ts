/** A dialog with one card per tree of the forest that lists its physical properties. */

import { tool } from "../controls/tools";
import { paperStateOf, stateWords } from "../paper/paperState";
import type { Catalogue, KnownTree } from "../server/catalogue";
import { reportOf } from "../server/reports";
import { make, makeButton } from "../ui/dom";
import { displayName } from "../ui/words";
import { type Fact, factsOf } from "./physics";

function factRow({ name, value, meaning }: Fact): HTMLElement {
  const row = make("div");
  const term = make("dt", name);
  term.append(make("small", meaning));
  row.append(term, make("dd", value));
  return row;
}

function card(known: KnownTree): HTMLElement {
  const { tree, motion } = known;
  const root = make("article", "", "physics-card");
  const list = make("dl");
  void reportOf(tree).then((report) => {
    const facts = factsOf({ height_m: tree.height_m, report }, motion?.bytes ?? null);
    list.replaceChildren(...facts.map(factRow));
  });
  const state = stateWords(known, paperStateOf(known, false));
  root.append(make("h3", displayName(tree)), make("p", state, "physics-state"), list);
  return root;
}

export class PhysicsCards {
  readonly tool = tool("trees", "Tree physics", () => this.open());
  private readonly dialog = make("dialog", "", "physics");
  private readonly cards = make("div", "", "physics-cards");

  constructor(private readonly catalogue: Catalogue) {
    const heading = make("h2", "Tree physics");
    heading.id = "physics-heading";
    this.dialog.setAttribute("aria-labelledby", heading.id);
    const words =
      "The wood of each species was simulated in many winds with the finite element method. The results are stored in " +
      "a table, from which every tree in the forest computes its own motion.";
    const close = makeButton("Close", () => this.dialog.close());
    this.dialog.addEventListener("click", (event) => {
      if (event.target === this.dialog) this.dialog.close(); // the backdrop
    });
    const head = make("header");
    head.append(heading, close);
    this.cards.tabIndex = 0;
    this.cards.setAttribute("role", "region");
    this.cards.setAttribute("aria-label", "Trees");
    this.dialog.append(head, make("p", words), this.cards);
    document.body.append(this.dialog);
  }

  open(): void {
    if (this.dialog.open) return;
    const ready = this.catalogue.known.filter(
      ({ tree }) => tree.state === "ready" || tree.state === "preliminary",
    );
    this.cards.replaceChildren(...ready.map(card));
    if (ready.length === 0) this.cards.append(make("p", "No tree has been computed yet."));
    this.dialog.showModal();
  }
}
