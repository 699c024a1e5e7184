/** Rows of the form of an upload: a name, a control and the reason for its value. */
import type { Limits } from "../settings/queryNumbers";
import { make } from "../ui/dom";

export function row(words: string, control: HTMLElement, reason: string): HTMLElement {
  const label = make("label", "", "own-tree-row");
  label.append(make("span", words), control, make("small", reason));
  return label;
}

export function numberField(
  value: number | null,
  limits: Limits,
  changed: (value: number | null) => void,
): HTMLInputElement {
  const made = make("input");
  const [min, max, step] = [limits.min, limits.max, limits.step].map(String);
  Object.assign(made, { type: "number", min, max, step, value: value?.toFixed(1) ?? "" });
  made.addEventListener("change", () =>
    changed(Number.isNaN(made.valueAsNumber) ? null : made.valueAsNumber),
  );
  return made;
}

export function select<Id extends string>(
  choices: readonly (readonly [id: Id, words: string])[],
  value: string,
  chosen: (value: Id) => void,
): HTMLSelectElement {
  const made = make("select");
  for (const [id, words] of choices) {
    const option = make("option", words);
    option.value = id;
    made.append(option);
  }
  made.value = value;
  made.addEventListener("change", () => chosen(made.value as Id));
  return made;
}

export function button(words: string, pressed: () => void): HTMLButtonElement {
  const made = make("button", words);
  made.type = "button";
  made.addEventListener("click", pressed);
  return made;
}
