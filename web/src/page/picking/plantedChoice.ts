/** How an upload is planted, as a row of buttons of which one is pressed. */
import type { Planted } from "../settings/planted";
import { make, makeButton } from "../ui/dom";

const CHOICES: readonly (readonly [Planted | null, string, string])[] = [
  ["one", "One", "One in the clearing"],
  ["more", "More", "Also among the other trees"],
  ["only", "Only", "Fill the forest with this tree"],
  [null, "None", "Remove it from this forest"],
];

export class PlantedChoice {
  readonly root = make("div", "", "planted-choice");
  private readonly buttons: readonly (readonly [Planted | null, HTMLButtonElement])[];

  constructor(chosen: (how: Planted | null) => void) {
    this.root.setAttribute("role", "group");
    this.root.setAttribute("aria-label", "How this upload is planted");
    this.buttons = CHOICES.map(([how, words, hint]) => {
      const button = makeButton(words, () => chosen(how));
      button.title = hint;
      return [how, button] as const;
    });
    this.root.append(make("span", "Planted"), ...this.buttons.map(([, button]) => button));
  }

  show(how: Planted | null): void {
    for (const [own, button] of this.buttons) button.setAttribute("aria-pressed", String(own === how));
  }
}
