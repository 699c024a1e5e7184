/** Card of a shared forest: how many are here, its link, and the code that embeds it. */
import { effect } from "@preact/signals-core";
import type { PageState } from "../store/store";
import { element, make, makeButton, write } from "../ui/dom";

/** "Nobody else is here yet." or "3 people are here, you included." Pure. */
export function presenceWords(clients: number | null): string {
  if (clients === null) return "Connecting …";
  return clients <= 1 ? "Nobody else is here yet." : `${clients} people are here, you included.`;
}

/** Makes the card, which is shown while the forest is shared. */
export function makeSharingCard(
  state: Pick<PageState, "share" | "present">,
  copyLink: () => void,
  embed: () => void,
): void {
  const root = make("article", "", "card sharing");
  root.setAttribute("aria-label", "Shared forest");
  const words = make("p");
  words.setAttribute("role", "status");
  const row = make("div", "", "picked-tools");
  row.append(makeButton("Copy link", copyLink), makeButton("Embed code", embed));
  root.append(make("h2", "Shared forest"), words, row);
  element("cards").prepend(root);
  effect(() => {
    root.hidden = state.share === null;
    write(words, presenceWords(state.present));
  });
}
