/** The controls of painting: what is painted, how wide, undo and redo, and the end. */

import { make } from "../../ui/dom";
import { whole } from "../../ui/words";
import { swatchOf } from "../pieces";
import { PAINTS, type Paint } from "./paintedKinds";

const WORDS: Record<Paint, string> = { wood: "Wood", leaves: "Leaves", other: "Leave out" };
const KEYS: Record<Paint, string> = { wood: "1", leaves: "2", other: "3" };
const SIZES = { min: 2, max: 40, start: 6 };

export interface PaintBarEvents {
  paint(kind: Paint): void;
  size(radius_px: number): void;
  undo(): void;
  redo(): void;
  /** Ends painting: the pieces are imported as painted, or stay as they were. */
  finish(keep: boolean): void;
}

export class PaintBar {
  readonly root = make("div", "", "own-tree-paint");
  private readonly undo = this.button("Undo", "Undo the last stroke (Ctrl+Z)", () => this.events.undo());
  private readonly redo = this.button("Redo", "Redo the last stroke (Ctrl+Y)", () => this.events.redo());
  private readonly keep = this.button("Apply", "Import the tree as painted", () => this.events.finish(true));
  private readonly line = make("small", "", "soft");

  constructor(private readonly events: PaintBarEvents) {
    const cancel = this.button("Cancel", "Discard all changes", () => this.events.finish(false));
    this.keep.classList.add("primary");
    this.line.setAttribute("role", "status");
    const row = make("div", "", "own-tree-paint-row");
    row.append(this.undo, this.redo, make("span", "", "own-tree-gap"), cancel, this.keep);
    this.root.append(this.kinds(), this.sizes(), row, this.line);
    this.show(0, false, false);
  }

  private kinds(): HTMLElement {
    const set = make("fieldset", "", "own-tree-paints");
    set.append(make("legend", "Paint"));
    for (const kind of PAINTS) {
      const label = make("label");
      const radio = make("input");
      Object.assign(radio, { type: "radio", name: "own-tree-paint", value: kind, checked: kind === "wood" });
      radio.addEventListener("change", () => this.events.paint(kind));
      label.title = `Key ${KEYS[kind]}`;
      label.append(radio, swatchOf(kind), make("span", WORDS[kind]));
      set.append(label);
    }
    return set;
  }

  private sizes(): HTMLElement {
    const label = make("label", "", "own-tree-size");
    const slider = make("input");
    const [min, max, value] = [SIZES.min, SIZES.max, SIZES.start].map(String);
    Object.assign(slider, { type: "range", min, max, value });
    slider.addEventListener("input", () => this.events.size(slider.valueAsNumber));
    label.append(make("span", "Brush"), slider);
    return label;
  }

  private button(words: string, title: string, pressed: () => void): HTMLButtonElement {
    const made = make("button", words);
    Object.assign(made, { type: "button", title });
    made.addEventListener("click", pressed);
    return made;
  }

  /** Keys that choose a paint, undo and redo. Returns whether the key was one of them. */
  key({ key, ctrlKey, metaKey, shiftKey }: KeyboardEvent): boolean {
    const letter = key.toLowerCase();
    if ((ctrlKey || metaKey) && (letter === "z" || letter === "y")) {
      if (letter === "y" || shiftKey) this.events.redo();
      else this.events.undo();
      return true;
    }
    const kind = PAINTS.find((one) => KEYS[one] === key);
    const radio = this.root.querySelector<HTMLInputElement>(`input[value="${kind}"]`);
    if (!kind || !radio || ctrlKey || metaKey) return false;
    radio.checked = true;
    this.events.paint(kind);
    return true;
  }

  /** Shows how many pieces have changed, and what is possible. */
  show(changed: number, undo: boolean, redo: boolean): void {
    this.undo.disabled = !undo;
    this.redo.disabled = !redo;
    this.keep.disabled = changed === 0;
    const pieces = changed === 1 ? "1 piece" : `${whole(changed)} pieces`;
    const hint = "Drag over the tree. The right button or two fingers turn it.";
    this.line.textContent = changed > 0 ? `${pieces} changed. ${hint}` : hint;
  }

  focus(): void {
    this.root.querySelector<HTMLInputElement>("input:checked")?.focus();
  }
}
