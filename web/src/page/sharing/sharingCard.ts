/** Card of a shared forest: how many are here, its link, and the code that embeds it. */
import { element, make } from "../ui/dom";

export interface SharingTools {
  copyLink(): void;
  embed(): void;
}

/** "You are alone here" or "3 people are here, with you". Pure. */
export function presenceWords(clients: number | null): string {
  if (clients === null) return "Connecting …";
  return clients <= 1 ? "Nobody else is here yet." : `${clients} people are here, you included.`;
}

export class SharingCard {
  private readonly root = make("article", "", "card sharing");
  private readonly words = make("p");

  constructor(tools: SharingTools) {
    this.root.hidden = true;
    this.root.setAttribute("aria-label", "Shared forest");
    this.words.setAttribute("role", "status");
    const row = make("div", "", "picked-tools");
    for (const [words, pressed] of [
      ["Copy link", () => tools.copyLink()],
      ["Embed code", () => tools.embed()],
    ] as const) {
      const button = make("button", words);
      button.type = "button";
      button.addEventListener("click", pressed);
      row.append(button);
    }
    this.root.append(make("h2", "Shared forest"), this.words, row);
    element("cards").prepend(this.root);
  }

  /** Shows the number of clients; null while it is unknown. */
  show(clients: number | null): void {
    this.root.hidden = false;
    const words = presenceWords(clients);
    if (this.words.textContent !== words) this.words.textContent = words;
  }

  dispose(): void {
    this.root.remove();
  }
}
