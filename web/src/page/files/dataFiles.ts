/** Dropped files that are no trees: measurements of the wind, winds, and inventories. */
import { parseWindText, WindError } from "galewood/wind";

/** What a text file holds. */
export type Kind = "inventory" | "measurement" | "wind";

export interface DataFileEvents {
  inventory(file: File): void;
  measurement(file: File): void;
  wind(file: File): void;
}

const TEXT_PATTERN = /\.(csv|tsv|txt|dat|json|geojson)$/i;
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
    if (!TEXT_PATTERN.test(file.name)) return false;
    const kind = await kindOf(file);
    if (kind === null) return false;
    (await this.ready)[kind](file);
    return true;
  }
}

/** What a file holds, by its first lines; null if it may be a tree. */
async function kindOf(file: File): Promise<Kind | null> {
  const { isInventory, isMeasurement, textOf } = await import("./reading");
  const text = textOf(await file.slice(0, SNIFFED_BYTES).arrayBuffer());
  if (/^\s*\{/.test(text)) return isWind(file.size > SNIFFED_BYTES ? "" : text) ? "wind" : "inventory";
  if (isInventory(text)) return "inventory";
  return isMeasurement(text) ? "measurement" : null;
}

function isWind(text: string): boolean {
  try {
    parseWindText(text);
    return true;
  } catch (error) {
    return error instanceof WindError && /^\s*\{[^[]*"model"/.test(text);
  }
}
