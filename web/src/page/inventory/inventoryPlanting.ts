/** Plants the forest from an inventory: that of an address, or that of a visitor's file. */

import type { Inventory } from "galewood/inventory";
import { extentOf, standView } from "../../scene/stand";
import type { World } from "../forest/world";
import { Problem } from "../server/api";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import { showToast } from "../ui/toast";
import { makeInventoryCard } from "./inventoryCard";
import { loadInventory, type NamedInventory, namedInventory, showInventory } from "./namedInventory";

const NOT_SHARED =
  "Put it at an address of this server (galewood forest FILE) and open the page with ?inventory=ADDRESS.";

/** Whether others can plant the same forest; says so if they cannot. */
export function canBeShared({ state, settings }: Store): boolean {
  if (state.inventory === null || settings.inventory !== "") return true;
  showToast("A forest from a file cannot be shared.", NOT_SHARED);
  return false;
}

export class InventoryPlanting {
  /** The inventory of a link that has a view: only this one does not move the camera. */
  private readonly linkedWithView: string | null;
  readonly card: HTMLElement;

  constructor(
    private readonly store: Store,
    private readonly world: World,
  ) {
    const { settings, opened } = store;
    this.linkedWithView = opened.eye === null ? null : settings.inventory;
    this.card = makeInventoryCard(store.state, {
      report: showInventory,
      look: (inventory) => this.look(inventory),
      remove: () => this.replace(null),
    });
    watch(
      () => [settings.inventory],
      ([address]) => void this.follow(address),
    );
    if (settings.inventory !== "") void this.follow(settings.inventory);
  }

  /** Plants the inventory of an address, unless another one is wanted by then. An empty address removes it. */
  private async follow(address: string): Promise<void> {
    const { settings, state } = this.store;
    if (address === "") {
      state.inventory = null;
      return;
    }
    state.inventory = "loading";
    let found: NamedInventory | null = null;
    try {
      found = await loadInventory(address);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      showToast(error.title, error.hint);
    } finally {
      if (settings.inventory === address) this.plant(found, address); // without one: the usual forest
    }
  }

  /** Plants the stems of a file, which has no address; in a shared forest the others could not see them. */
  open(inventory: Inventory, file: File): void {
    if (this.store.state.share !== null) {
      showToast("A shared forest cannot be planted from a file.", NOT_SHARED);
      return;
    }
    const found = namedInventory(inventory, file.name, file);
    this.replace(found);
    showInventory(found);
  }

  /** Plants the stems of a file, or none. Trees that were grown for the former ones do not suit them. */
  private replace(inventory: NamedInventory | null): void {
    this.store.settings.ownTrees = 0;
    this.plant(inventory, "");
  }

  private plant(inventory: NamedInventory | null, address: string): void {
    const { settings, state } = this.store;
    settings.inventory = address;
    state.inventory = inventory;
    if (inventory && (address === "" || address !== this.linkedWithView)) this.look(inventory);
  }

  /** Shows all of the stand. */
  private look({ stems }: NamedInventory): void {
    const { eye, target } = standView(extentOf(stems), this.world.stage.camera.aspect);
    this.world.look(eye, target);
  }
}
