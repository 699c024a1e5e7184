/** The inventory from which the forest is planted: from an address, or from a file of the visitor. */

import type { Inventory } from "galewood/inventory";
import { InventoryError, SCALES } from "galewood/inventory";
import { showReport } from "../ui/reportDialog";

const LARGEST_BYTES = 32 * 1024 ** 2;
const NOT_READ = "The inventory could not be read.";

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

export class InventoryForest {
  current: NamedInventory | null = null;
  /** While an inventory is on its way, no other forest is planted. */
  loading = false;

  constructor(private readonly events: InventoryEvents) {}

  /** Loads the inventory of an address of this server; an empty one removes it. */
  async follow(address: string): Promise<void> {
    this.current = null;
    if (address === "") {
      this.events.changed();
      return;
    }
    const url = new URL(address, document.baseURI);
    await this.load(url.pathname.replace(/^.*\//, ""), async (rename) => {
      if (url.origin !== location.origin) {
        throw new InventoryError("the address must belong to this server; drop the file on the page instead");
      }
      const response = await fetch(url);
      if (!response.ok) throw new InventoryError(`${url.href}: the server answered ${response.status}`);
      const named = /filename="([^"]+)"/.exec(response.headers.get("content-disposition") ?? "");
      if (named) rename(named[1]);
      return new Uint8Array(await response.arrayBuffer());
    });
  }

  /** Reads a file of the visitor, and shows what was understood. */
  async open(file: File): Promise<void> {
    await this.load(file.name, async () => {
      if (file.size > LARGEST_BYTES) throw new InventoryError("the file is larger than 32 MB");
      return new Uint8Array(await file.arrayBuffer());
    });
    if (this.current) this.report();
  }

  /** `bytes` returns the content, and may learn the file's name meanwhile. */
  private async load(
    given: string,
    bytes: (rename: (name: string) => void) => Promise<Uint8Array>,
  ): Promise<void> {
    this.loading = true;
    let name = given;
    try {
      const { readInventory } = await import("../files/reading");
      const read = readInventory(
        await bytes((real) => {
          name = real;
        }),
      );
      const names = new Set(read.stems.map(({ species }) => species.trim().toLowerCase()));
      this.current = { ...read, name, names };
    } catch (error) {
      const known = error instanceof InventoryError || error instanceof TypeError; // a failed fetch
      if (!known) throw error;
      this.events.problem(NOT_READ, `${error.message[0].toUpperCase()}${error.message.slice(1)}.`);
    } finally {
      this.loading = false;
      this.events.changed();
    }
  }

  /** Shows what was understood. */
  report(): void {
    const { current } = this;
    if (!current) return;
    const { report } = current;
    const metres = (value: number) => `${value.toFixed(0)} m`;
    showReport({
      heading: "Forest from an inventory",
      file: current.name,
      figures: [
        ["Trees", `${report.stems} of ${report.rows} rows`],
        [
          "Plot",
          `${metres(report.width_m)} × ${metres(report.depth_m)}, ${report.per_ha.toFixed(0)} per hectare`,
        ],
        ["Heights", `${report.lowest_m.toFixed(1)} to ${report.highest_m.toFixed(1)} m`],
        ...Object.entries(report.columns).map(([what, column]): [string, string] => [
          `Column for ${what}`,
          column,
        ]),
      ],
      notes: notesOf(current),
    });
  }
}

/** Assumptions, substitutes and skipped rows, as sentences. */
function notesOf({ report }: NamedInventory): string[] {
  const substitutes = report.substitutes.map(({ name, builtin, genus, stems }) => {
    const who = name === "" ? "no species" : name;
    return `${who}${genus === "" && name !== "" ? " (unknown)" : ""} is shown as ${builtin}: ${stems}`;
  });
  const skipped = report.first_skipped.map(({ line, reason }) => `Row ${line}: ${reason}`);
  const more = report.skipped - skipped.length;
  return [
    ...(substitutes.length > 0
      ? [`Substitutes (tree species that the server does not have): ${substitutes.join("; ")}.`]
      : []),
    "Trees are scaled to their height; trunk diameter scales with it." +
      ` Sizes are limited to ${SCALES.least} to ${SCALES.most} times that of the tree model.`,
    ...report.notes,
    ...(report.skipped > 0
      ? [`${report.skipped} rows were skipped. ${skipped.join("; ")}${more > 0 ? `; and ${more} more` : ""}.`]
      : []),
  ];
}
