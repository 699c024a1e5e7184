/** The inventory from which the forest is planted: from an address, or from a file of the visitor. */

import { type Inventory, SCALES } from "galewood/inventory";
import { fetchApi, Problem } from "../server/api";
import { showReport } from "../ui/reportDialog";

export interface InventoryEvents {
  /** There is another inventory, or none any more. */
  changed(): void;
  problem(title: string, hint: string): void;
}

/** An inventory and the name of its file. */
export interface NamedInventory extends Inventory {
  readonly name: string;
  /** The species in it, in lower case. */
  readonly names: ReadonlySet<string>;
}

const named = (inventory: Inventory, name: string): NamedInventory => ({
  ...inventory,
  name,
  names: new Set(inventory.stems.map(({ species }) => species.trim().toLowerCase())),
});

export class InventoryForest {
  current: NamedInventory | null = null;

  constructor(private readonly events: InventoryEvents) {}

  /** Loads the inventory document of an address of this server; an empty one removes the inventory. */
  async follow(address: string): Promise<void> {
    this.current = null;
    try {
      if (address !== "") this.current = await loaded(new URL(address, document.baseURI));
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      this.events.problem(error.title, error.hint);
    }
    this.events.changed();
  }

  /** Takes the inventory of a visitor's file, and shows what was understood. */
  open(inventory: Inventory, name: string): void {
    this.current = named(inventory, name);
    this.events.changed();
    this.report();
  }

  /** Shows what was understood. */
  report(): void {
    const { current } = this;
    if (!current) return;
    const { name, stems, report } = current;
    showReport({
      heading: "Forest from an inventory",
      file: name,
      figures: Object.entries(report?.figures ?? { Trees: String(stems.length) }),
      notes: [
        "Trees are scaled to their height; trunk diameter scales with it." +
          ` Sizes are limited to ${SCALES.least} to ${SCALES.most} times that of the tree model.`,
        ...(report?.notes ?? []),
      ],
    });
  }
}

async function loaded(url: URL): Promise<NamedInventory> {
  if (url.origin !== location.origin) {
    throw new Problem(
      "The inventory could not be read.",
      "The address must belong to this server; drop the file on the page instead.",
    );
  }
  const response = await fetchApi(url.href);
  const { inventoryFrom } = await import("../files/content");
  const real = /filename="([^"]+)"/.exec(response.headers.get("content-disposition") ?? "");
  return named(inventoryFrom(await response.text()), real?.[1] ?? url.pathname.replace(/^.*\//, ""));
}
