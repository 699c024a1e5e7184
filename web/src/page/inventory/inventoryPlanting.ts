/** The inventory of the page: where it comes from, its card, and what it changes in the forest. */

import type { Stage } from "../../scene/stage";
import { standView } from "../../scene/stand";
import type { Planting } from "../planting";
import type { Catalogue } from "../server/catalogue";
import { momentFrom } from "../settings/link";
import type { Settings } from "../settings/settings";
import { InventoryCard } from "../ui/inventoryCard";
import { showToast } from "../ui/toast";
import { InventoryForest } from "./inventoryForest";

const NOT_SHARED =
  "Put it at an address of this server (galewood forest FILE) and open the page with ?inventory=ADDRESS.";

/** What it needs of the page. */
export interface InventoryPlace {
  readonly settings: Settings;
  readonly stage: Stage;
  readonly catalogue: Catalogue;
  readonly planting: Planting;
  look(eye: ReturnType<typeof standView>["eye"], at: ReturnType<typeof standView>["target"]): void;
  /** The address of the inventory has changed. */
  changed(): void;
  /** It was replaced by a file, which has no address. */
  remember(): void;
}

export class InventoryPlanting {
  readonly forest = new InventoryForest({ changed: () => this.arrived(), problem: showToast });
  private readonly card = new InventoryCard({
    report: () => this.forest.report(),
    look: () => this.showStand(),
    remove: () => this.remove(),
  });

  constructor(private readonly page: InventoryPlace) {}

  /** Loads the inventory that the settings name. */
  follow(): void {
    void this.forest.follow(this.page.settings.inventory);
  }

  /** Plants the stems of a file; in a shared forest the others could not see them. */
  async open(file: File): Promise<void> {
    if (this.page.planting.share !== null) {
      showToast("A shared forest cannot be planted from a file.", NOT_SHARED);
      return;
    }
    this.page.settings.inventory = "";
    await this.forest.open(file);
    this.page.remember();
  }

  private remove(): void {
    this.page.settings.inventory = "";
    this.page.changed();
  }

  private arrived(): void {
    this.card.show(this.forest.current);
    this.page.catalogue.choose();
    this.page.planting.place(true);
    if (momentFrom(location.search).eye === null) this.showStand();
  }

  /** Shows all of the stand. */
  private showStand(): void {
    const { current } = this.forest;
    if (!current) return;
    const { eye, target } = standView(current.report, this.page.stage.camera.aspect);
    this.page.look(eye, target);
  }

  /** Whether an upload has the name of a species in the inventory. */
  holds(id: string): boolean {
    const { current } = this.forest;
    if (!current) return false;
    const name = this.page.catalogue.uploads.find((upload) => upload.id === id)?.name ?? "";
    return current.names.has(id.toLowerCase()) || current.names.has(name.toLowerCase());
  }

  /** Whether others can plant the same; says so if they cannot. */
  canBeShared(): boolean {
    if (!this.forest.current || this.page.settings.inventory !== "") return true;
    showToast("A forest from a file cannot be shared.", NOT_SHARED);
    return false;
  }

  dispose(): void {
    this.card.dispose();
  }
}
