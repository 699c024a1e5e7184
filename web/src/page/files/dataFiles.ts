/** Dropped files that are no trees: measurements of the wind, winds, and inventories. */
import { parseWindText, WindError } from "../../core/wind/wind";

/** What a text file holds. */
export type Kind = "inventory" | "measurement" | "wind";

export interface DataFileEvents {
  inventory(file: File): void;
  measurement(file: File): void;
  wind(file: File): void;
}

const TEXT = /\.(csv|tsv|txt|dat|json|geojson)$/i;
const SNIFFED_BYTES = 65_536;

export class DataFiles {
  private open: (events: DataFileEvents) => void = () => {};
  /** Files may be dropped before the page is ready. */
  private readonly ready = new Promise<DataFileEvents>((resolve) => {
    this.open = resolve;
  });

  /** Files are passed on from now on. */
  connect(events: DataFileEvents): void {
    this.open(events);
  }

  /** Passes a file on if it is no tree; returns whether it did. */
  async take(file: File): Promise<boolean> {
    if (!TEXT.test(file.name)) return false;
    const kind = await kindOf(file);
    if (kind === null) return false;
    (await this.ready)[kind](file);
    return true;
  }
}

/** What a file holds, by its first lines; null if it may be a tree. */
async function kindOf(file: File): Promise<Kind | null> {
  const { readRows, textOf } = await import("./rows");
  const text = textOf(new Uint8Array(await file.slice(0, SNIFFED_BYTES).arrayBuffer()));
  if (/^\s*\{/.test(text)) return isWind(file.size > SNIFFED_BYTES ? "" : text) ? "wind" : "inventory";
  const rows = readRows(text).slice(0, 100);
  const { columnsOf } = await import("../../core/inventory/columns");
  if (rows.some((row) => columnsOf(row) !== null)) return "inventory";
  const wind = await import("../../core/wind/measured/columns");
  return rows.some((row) => wind.columnsOf(row) !== null) ? "measurement" : null;
}

function isWind(text: string): boolean {
  try {
    parseWindText(text);
    return true;
  } catch (error) {
    return error instanceof WindError && /^\s*\{[^[]*"model"/.test(text);
  }
}
