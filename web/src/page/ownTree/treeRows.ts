/** Rows of the form of an upload: which tree of the file, and whether wood that the file lacks is added. */
import type { Assumptions } from "../server/api";
import type { FoundTree } from "./assumed";
import { button, row, select } from "./formRows";
import { AS_DETECTED } from "./pieces";

type Change = (assumptions: Assumptions) => void;

/** Which tree of a file with several is imported, or all; nothing for a single tree. */
export function treeRows(trees: readonly FoundTree[], change: Change, importAll: () => void): HTMLElement[] {
  if (trees.length < 2) return [];
  const words = trees.map(({ number, name, height_m }) => {
    const named = name ? `${name}, ` : "";
    return [String(number), `${number} of ${trees.length}: ${named}${height_m.toFixed(1)} m`] as const;
  });
  const taken = trees.find((tree) => tree.taken)?.number ?? 1;
  const made = select(words, String(taken), (value) => change({ tree: Number(value), ...AS_DETECTED }));
  const all = button(`Import all ${trees.length} trees`, importAll);
  all.classList.add("own-tree-all");
  return [row("Tree", made, "the file has several; each can become a tree of its own"), all];
}

/** Whether wood is added where foliage has none; `reason` says why it was, null if it was not. */
export function addedWoodRow(reason: string | null, change: Change): HTMLElement {
  const choices = [
    ["added", "Added"],
    ["none", "None"],
  ] as const;
  const made = select(choices, reason === null ? "none" : "added", (value) =>
    change({ complete: value === "added" ? null : false }),
  );
  const without = "foliage without wood stays rigid, or bends with the nearest branch";
  return row("Missing wood", made, reason ?? without);
}
