/** "About": what the page shows, how it is made and how far it is off. */
import { element, make, makeButton } from "../ui/dom";

const PARAGRAPHS = [
  "Every tree moves by itself, in a wind that you control. Nothing is animated by hand, and no motion is repeated.",
  "Method: the wood of a tree is filled with tetrahedra, stiffer along the grain. A corotational finite element simulation " +
    "computes how it moves in training winds. This is reduced to a few modes and stored in a table of less than half a " +
    "megabyte, which plays the tree in any wind: thousands of trees at once, each in its own gusts.",
  "Error: in gusts that differ within the crown, the 24 built-in trees are off by 1 to 29 % of their sway from the " +
    "full simulation (root mean squares); in winds that are the same over the whole crown, with peaks of 12 m/s, by less than " +
    "2.7 % of their height. “Accuracy” simulates a tree in the present wind in full and shows both side by side.",
  "The other method, in the settings, is that of the paper: a search for the most similar recorded state.",
];
const LINKS = [
  ["Reference of the service (REST)", "docs"],
  [
    "The paper: Real-time Physically Plausible Simulation of Forest",
    "https://scholar.google.com/scholar?q=%22Real-time+Physically+Plausible+Simulation+of+Forest%22",
  ],
] as const;
const GUIDE_WORDS =
  "The guide, with physics, formats and measurements, is the folder docs of the source (make docs).";

function link([words, href]: readonly [string, string]): HTMLElement {
  const made = make("a", words);
  Object.assign(made, { href, target: "_blank", rel: "noreferrer" });
  const item = make("li");
  item.append(made);
  return item;
}

function show(): void {
  const dialog = make("dialog", "", "physics report-dialog about-dialog");
  const title = make("h2", "About Galewood");
  title.id = "about-heading";
  dialog.setAttribute("aria-labelledby", title.id);
  const head = make("header");
  head.append(
    title,
    makeButton("Close", () => dialog.close()),
  );
  const links = make("ul");
  links.append(...LINKS.map(link), make("li", GUIDE_WORDS));
  dialog.append(head, ...PARAGRAPHS.map((words) => make("p", words)), links);
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/** Connects the button below the title. */
export function connectAbout(): void {
  element("about").addEventListener("click", show);
}
