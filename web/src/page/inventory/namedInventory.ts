/** An inventory and the name of its file: how it is loaded from an address, and what is said of it. */

import { type Inventory, SCALES } from "galewood/inventory";
import { fetchApi, Problem } from "../server/api";
import { loadPart } from "../server/connected";
import { showReport } from "../ui/reportDialog";

const UNREADABLE_TITLE = "The inventory could not be read.";

export interface NamedInventory extends Inventory {
  readonly name: string;
  /** The species in it, in lower case. */
  readonly names: ReadonlySet<string>;
  /** The built-in species that stand for them. */
  readonly builtin: ReadonlySet<string>;
  /** Its file, or its document. */
  readonly source: Blob;
}

export const namedInventory = (inventory: Inventory, name: string, source: Blob): NamedInventory => ({
  ...inventory,
  name,
  source,
  names: new Set(inventory.stems.map(({ species }) => species.trim().toLowerCase())),
  builtin: new Set(inventory.stems.map(({ builtin }) => builtin)),
});

/** Loads the inventory document of an address of this server. Throws a Problem. */
export async function loadInventory(address: string): Promise<NamedInventory> {
  const url = URL.canParse(address, document.baseURI) ? new URL(address, document.baseURI) : null;
  if (url?.origin !== location.origin) {
    throw new Problem(
      UNREADABLE_TITLE,
      "The address must belong to this server; drop the file on the page instead.",
    );
  }
  const response = await fetchApi(url.href).catch((error: unknown) => {
    if (!(error instanceof Problem)) throw error;
    throw new Problem(UNREADABLE_TITLE, `${url.href}: ${error.title}`);
  });
  const { inventoryFrom } = await loadPart(() => import("../files/content"));
  const real = /filename="([^"]+)"/.exec(response.headers.get("content-disposition") ?? "");
  const name = real?.[1] ?? url.pathname.replace(/^.*\//, "");
  const text = await response.text();
  return namedInventory(inventoryFrom(text), name, new Blob([text]));
}

/** Shows how the file was interpreted. */
export function showInventory({ name, stems, report }: NamedInventory): void {
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
