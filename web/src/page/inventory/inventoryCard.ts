/** Card of a forest from an inventory: its size, the report, and back to the usual forest. */
import { effect } from "@preact/signals-core";
import { extentOf } from "../../scene/stand";
import type { PageState } from "../store/store";
import { element, make, makeButton } from "../ui/dom";
import type { NamedInventory } from "./namedInventory";

export interface InventoryTools {
  report(inventory: NamedInventory): void;
  look(inventory: NamedInventory): void;
  remove(): void;
}

/** Makes the card, which is shown while an inventory is planted; returns it. */
export function makeInventoryCard(state: Pick<PageState, "inventory">, tools: InventoryTools): HTMLElement {
  const root = make("article", "", "card inventory");
  root.setAttribute("aria-label", "Forest from an inventory");
  const words = make("p");
  const planted = () => (state.inventory === "loading" ? null : state.inventory);
  const button = (name: string, pressed: (inventory: NamedInventory) => void) =>
    makeButton(name, () => {
      const inventory = planted();
      if (inventory) pressed(inventory);
    });
  const row = make("div", "", "picked-tools");
  row.append(button("Report", tools.report), button("Show all", tools.look), button("Remove", tools.remove));
  root.append(make("h2", "Inventory"), words, row);
  element("cards").prepend(root);
  effect(() => {
    const inventory = planted();
    root.hidden = inventory === null;
    if (!inventory) return;
    const { name, stems } = inventory;
    const { width_m, depth_m } = extentOf(stems);
    words.textContent = `${name}: ${stems.length} trees on ${width_m.toFixed(0)} × ${depth_m.toFixed(0)} m`;
  });
  return root;
}
