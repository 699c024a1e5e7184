/** The up axis in the form of an upload: a row, or a question if the server is unsure. */
import { make } from "../ui/dom";
import type { Assumed } from "./assumed";
import { button, row, select } from "./formRows";

const AXES = [
  ["y", "Y"],
  ["z", "Z"],
  ["x", "X"],
  ["-y", "−Y"],
  ["-z", "−Z"],
  ["-x", "−X"],
] as const;
type UpAxis = (typeof AXES)[number][0];

export function upAxisRow({ axis }: Assumed, change: (axis: UpAxis) => void): HTMLElement {
  if (!axis.unsure) return row("Up axis", select(AXES, axis.value, change), axis.reason);
  const question = make("fieldset", "", "own-tree-question");
  question.append(make("legend", "Does the tree stand upright?"));
  const yes = make("div", "", "own-tree-answers");
  const no = make("div", "", "own-tree-answers");
  const [assumed, name] = AXES.find(([id]) => id === axis.value) ?? AXES[0];
  yes.append(button(`Yes, ${name} is up`, () => change(assumed)));
  no.append(
    make("span", "No, up is"),
    ...AXES.filter(([id]) => id !== assumed).map(([id, words]) => button(words, () => change(id))),
  );
  question.append(yes, no);
  return question;
}
