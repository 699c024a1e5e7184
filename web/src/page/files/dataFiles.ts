/** Files that are no trees, dropped or chosen: winds, measurements of the wind, and inventories. */
import type { Inventory } from "galewood/inventory";
import type { WindDocument } from "galewood/wind";
import { loadPart, withServer } from "../server/connected";
import { showToast } from "../ui/toast";

export interface DataFileEvents {
  inventory(inventory: Inventory, file: File): void;
  wind(wind: WindDocument): void;
}

/** From then on a reading is mentioned. */
const SLOW_MS = 2000;
const TEXT_PATTERN = /\.(csv|tsv|txt|dat|json|geojson)$/i;

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
    const slow = setTimeout(
      () => showToast(`Reading ${file.name}`, "A large file takes a while.", "good"),
      SLOW_MS,
    );
    let taken = true;
    await withServer(`${file.name} was not read; the page keeps it.`, async () => {
      taken = await this.pass(file);
    });
    clearTimeout(slow);
    return taken;
  }

  /** Passes on a file that is to be a wind. */
  async takeWind(file: File): Promise<void> {
    if (!(await this.take(file))) {
      showToast(
        "The file contains no wind.",
        "Expected a wind document (JSON), or the recording of an anemometer with columns of time, speed and direction.",
      );
    }
  }

  private async pass(file: File): Promise<boolean> {
    const { contentOf } = await loadPart(() => import("./content"));
    const content = await contentOf(file);
    if (content === null) return false;
    const events = await this.ready;
    if (content.kind === "inventory") events.inventory(content.inventory, file);
    else if (content.kind === "wind") events.wind(content.wind);
    else {
      const { playMeasuredWind } = await loadPart(() => import("./measuredWind"));
      playMeasuredWind(file, content.found, events.wind);
    }
    return true;
  }
}
