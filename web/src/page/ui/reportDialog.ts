/** A dialog that shows how a file was interpreted. */
import { make, makeButton } from "./dom";

export interface ReportWords {
  readonly heading: string;
  readonly file: string;
  /** Name and value of each figure. */
  readonly figures: readonly (readonly [name: string, value: string])[];
  /** Assumptions and faults, as sentences. */
  readonly notes: readonly string[];
  /** A control below the figures. */
  readonly control?: HTMLElement;
}

/** Shows a report; returns a function that closes it. */
export function showReport({ heading, file, figures, notes, control }: ReportWords): () => void {
  const dialog = make("dialog", "", "physics report-dialog");
  const title = make("h2", heading);
  title.id = "report-heading";
  dialog.setAttribute("aria-labelledby", title.id);
  const close = makeButton("Close", () => dialog.close());
  dialog.addEventListener("close", () => dialog.remove());
  const head = make("header");
  head.append(title, close);
  const list = make("dl");
  for (const [name, value] of figures) list.append(make("dt", name), make("dd", value));
  const sentences = make("ul");
  sentences.append(...notes.map((note) => make("li", note)));
  dialog.append(head, make("p", file), list);
  if (control) dialog.append(control);
  if (notes.length > 0) dialog.append(sentences);
  document.body.append(dialog);
  dialog.showModal();
  return () => dialog.close();
}
