/** The parts in reports of older imports, which know no pieces: each with a checkbox that marks it as wood. */
import { make } from "../ui/dom";
import type { Part } from "./assumed";

/** `choose` is called with the names of all parts that are wood, null if none is. */
export function olderParts(parts: readonly Part[], choose: (wood: string[] | null) => void): HTMLElement {
  const set = make("fieldset");
  set.append(make("legend", "Detected parts (checked = wood)"));
  for (const part of parts) {
    const box = make("input");
    Object.assign(box, { type: "checkbox", checked: part.wood, value: part.name, disabled: !part.name });
    box.addEventListener("change", () => {
      const chosen = [...set.querySelectorAll("input:checked")].map((one) => (one as HTMLInputElement).value);
      choose(chosen.length > 0 ? chosen : null);
    });
    const label = make("label");
    label.append(
      box,
      make("span", part.name || "unnamed"),
      make("small", `${part.faces.toLocaleString("en")} faces; ${part.reason}`),
    );
    set.append(label);
  }
  return set;
}
