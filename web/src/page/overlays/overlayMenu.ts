/** Menu on the card of the picked tree: what to draw on it, and which mode. */
import { make, makeButton, write } from "../ui/dom";

const OVERLAYS = {
  none: "Nothing",
  skeleton: "Skeleton",
  tetrahedra: "Tetrahedra",
  modes: "Natural modes",
  wind: "Wind",
  strain: "Strain in wind",
  error: "Error of the table",
} as const;

export type OverlayKind = keyof typeof OVERLAYS;

export interface OverlayChoice {
  chosen(kind: OverlayKind): void;
  /** The next mode (1), or the one before (−1). */
  mode(step: number): void;
}

export class OverlayMenu {
  readonly element = make("div", "", "overlay-menu");
  private readonly select = make("select");
  private readonly note = make("p", "", "overlay-note");
  private readonly steps = make("span", "", "overlay-modes");

  constructor(choice: OverlayChoice) {
    for (const [kind, words] of Object.entries(OVERLAYS)) this.select.append(new Option(words, kind));
    this.select.addEventListener("change", () => choice.chosen(this.select.value as OverlayKind));
    const label = make("label");
    label.append(make("span", "Show on the tree"), this.select);
    for (const [words, name, step] of [
      ["‹", "Previous mode", -1],
      ["›", "Next mode", 1],
    ] as const) {
      const button = makeButton(words, () => choice.mode(step));
      button.setAttribute("aria-label", name);
      this.steps.append(button);
    }
    this.note.setAttribute("role", "status");
    this.element.append(label, this.steps, this.note);
    this.show("none", "");
  }

  show(kind: OverlayKind, note: string): void {
    this.select.value = kind;
    this.steps.hidden = kind !== "modes";
    this.note.hidden = note === "";
    write(this.note, note);
  }
}
