/** The inventory of the page: where it comes from, and its card. */

import type { Inventory } from "galewood/inventory";
import { extentOf, standView } from "../../scene/stand";
import type { World } from "../forest/world";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { InventoryCard } from "./inventoryCard";
import { showToast } from "../ui/toast";
import { InventoryForest } from "./inventoryForest";

const NOT_SHARED =
  "Put it at an address of this server (galewood forest FILE) and open the page with ?inventory=ADDRESS.";

/** Whether others can plant the same forest; says so if they cannot. */
export function canBeShared({ state, settings }: Store): boolean {
  if (state.inventory === null || settings.inventory !== "") return true;
  showToast("A forest from a file cannot be shared.", NOT_SHARED);
  return false;
}

export class InventoryPlanting {
  private readonly forest = new InventoryForest({ changed: () => this.arrived(), problem: showToast });
  private readonly card = new InventoryCard({
    report: () => this.forest.report(),
    look: () => this.showStand(),
    remove: () => this.remove(),
  });
  /** Whether the inventory is that of a file, which has no address. */
  private fromFile = false;

  constructor(
    private readonly store: Store,
    private readonly world: World,
  ) {
    const { settings } = store;
    watch(
      () => [settings.inventory],
      ([address]) => {
        if (address !== "" || !this.fromFile) this.follow(address);
      },
    );
    if (settings.inventory !== "") this.follow(settings.inventory);
  }

  /** Loads the inventory of an address; an empty one removes it. */
  private follow(address: string): void {
    this.fromFile = false;
    this.store.state.inventory = "loading";
    void this.forest.follow(address);
  }

  /** Plants the stems of a file; in a shared forest the others could not see them. */
  open(inventory: Inventory, name: string): void {
    const { settings, state } = this.store;
    if (state.share !== null) {
      showToast("A shared forest cannot be planted from a file.", NOT_SHARED);
      return;
    }
    this.fromFile = true;
    state.inventory = "loading";
    settings.inventory = "";
    this.forest.open(inventory, name);
  }

  private remove(): void {
    this.fromFile = false;
    if (this.store.settings.inventory === "") this.follow("");
    else this.store.settings.inventory = "";
  }

  private arrived(): void {
    this.card.show(this.forest.current);
    this.store.state.inventory = this.forest.current;
    if (this.store.opened.eye === null) this.showStand();
  }

  /** Shows all of the stand. */
  private showStand(): void {
    const { current } = this.forest;
    if (!current) return;
    const { eye, target } = standView(extentOf(current.stems), this.world.stage.camera.aspect);
    this.world.look(eye, target);
  }
}
