/** Card of a forest from an inventory: its size, the report, and back to the usual forest. */
import { extentOf } from "../../scene/stand";
import type { NamedInventory } from "./inventoryForest";
import { element, make } from "../ui/dom";

export interface InventoryTools {
  report(): void;
  look(): void;
  remove(): void;
}

export class InventoryCard {
  private readonly root = make("article", "", "card inventory");
  private readonly words = make("p");

  constructor(tools: InventoryTools) {
    this.root.hidden = true;
    this.root.setAttribute("aria-label", "Forest from an inventory");
    const row = make("div", "", "picked-tools");
    for (const [words, pressed] of [
      ["Report", () => tools.report()],
      ["Show all", () => tools.look()],
      ["Remove", () => tools.remove()],
    ] as const) {
      const button = make("button", words);
      button.type = "button";
      button.addEventListener("click", pressed);
      row.append(button);
    }
    this.root.append(make("h2", "Inventory"), this.words, row);
    element("cards").prepend(this.root);
  }

  show(inventory: NamedInventory | null): void {
    this.root.hidden = inventory === null;
    if (!inventory) return;
    const { name, stems } = inventory;
    const { width_m, depth_m } = extentOf(stems);
    this.words.textContent = `${name}: ${stems.length} trees on ${width_m.toFixed(0)} × ${depth_m.toFixed(0)} m`;
  }

  dispose(): void {
    this.root.remove();
  }
}
