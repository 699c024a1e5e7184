/**
 * The forest's own trees: has the server grow as many as the settings say, for the stems of an inventory or for the
 * generated forest, and plants them when all are there. What is grown follows from the settings alone, so a link with them
 * gives the same trees.
 */

import { batch } from "@preact/signals-core";
import { sizesOfForest, treesOfForest } from "../../scene/forestIndividuals";
import {
  type Individual,
  nearestIndividual,
  type Order,
  type Size,
  sizeOfStem,
  treesToGrow,
} from "../../scene/individuals";
import type { Catalogue } from "../server/catalogue";
import { watch } from "../store/signals";
import type { GrowthState, Store } from "../store/store";
import { showToast } from "../ui/toast";
import { CannotGrow, type Grown, Growth } from "./growth";

/** The trees of a server, as far as its own trees depend on them. */
export type Trees = Pick<Catalogue, "onChange" | "builtinTrees" | "assetChanges" | "isLoaded">;

export class Individuals {
  private readonly growth: Growth;
  /** What was asked for last, as a text; null: nothing yet. */
  private asked: string | null = null;
  /** What is planted: the number that was asked for, and the trees, as a text. */
  private planted = { number: 0, orders: "" };
  /** Whether the visitor has chosen the number, and may be asked for the key of the server. */
  private chosen = false;

  constructor(
    private readonly store: Store,
    private readonly catalogue: Trees,
  ) {
    const { settings, state } = store;
    // A shared forest waits for them: it keeps the trees of the first request.
    if (settings.ownTrees > 0) state.growth = { at: "growing", done: 0, all: settings.ownTrees };
    this.growth = new Growth(catalogue, {
      progress: (done, all) => {
        state.growth = { at: "growing", done, all };
      },
      end: (grown) => this.plant(grown),
    });
    watch(
      () => [settings.ownTrees],
      () => {
        this.chosen = !store.isAdopting;
      },
    );
    watch(
      () => [state.inventory],
      () => this.forget(), // they are those of other stems
    );
    watch(
      () => [
        settings.ownTrees,
        settings.trees,
        settings.forestSeed,
        settings.density,
        settings.shares,
        settings.form,
        settings.planted,
        state.inventory,
        state.treesSeen,
        catalogue.assetChanges.value,
      ],
      () => this.follow(),
    );
    this.follow();
  }

  /** What the visitor can do. */
  readonly tools = {
    grow: (number: number) => {
      const { settings } = this.store;
      if (settings.ownTrees !== number) settings.ownTrees = number;
      else this.tools.again();
    },
    again: () => {
      this.asked = null;
      this.chosen = true;
      this.follow();
    },
    /** Ends growing. The forest stays as it is, and the settings name the trees that it has. */
    cancel: () => {
      const { settings } = this.store;
      const { number, orders } = this.planted;
      this.growth.cancel();
      this.asked = null;
      settings.ownTrees = textOf(this.ordersFor(number)) === orders ? number : 0;
    },
    /** Back to the built-in trees. */
    leave: () => {
      this.store.settings.ownTrees = 0;
    },
  };

  private forget(): void {
    const { state } = this.store;
    this.growth.cancel();
    this.asked = null;
    this.planted = { number: 0, orders: "" };
    if (state.individuals.length > 0) state.individuals = [];
  }

  /** Asks for the trees of the settings, unless it has done so. */
  private follow(): void {
    const { settings, state } = this.store;
    const { ownTrees } = settings;
    // Until the forest is seen its trees load, which matters more; and a server tells of its trees one after the other.
    if (ownTrees > 0 && !(state.treesSeen && this.catalogue.isLoaded && state.inventory !== "loading"))
      return;
    const orders = this.ordersFor(ownTrees);
    const text = textOf(orders);
    if (text === this.asked) {
      // the same trees may stand for more or fewer
      if (state.growth.at === "planted") state.growth = this.plantedState(state.individuals);
      return;
    }
    this.asked = text;
    if (text === this.planted.orders || orders.length === 0) {
      this.growth.cancel();
      const kept = orders.length > 0 ? state.individuals : [];
      this.planted = { number: ownTrees, orders: text };
      this.show(kept, orders.length > 0 ? this.plantedState(kept) : { at: "none" });
    } else void this.growth.start(orders, this.chosen);
    this.chosen = false;
  }

  private ordersFor(number: number): Order[] {
    const { settings, state } = this.store;
    const { inventory } = state;
    if (number === 0 || inventory === "loading") return [];
    if (inventory) return treesToGrow(inventory.stems, number, settings.form);
    // where only an upload is planted, no tree of its own would be seen
    if (Object.values(settings.planted).includes("only")) return [];
    return treesOfForest(this.catalogue.builtinTrees, settings, number);
  }

  private plant({ trees, faults, problem }: Grown): void {
    const { settings } = this.store;
    if (faults.length > 0) {
      const all = faults.length + trees.length;
      showToast(`${faults.length} of ${all} trees could not be grown.`, faults[0]);
    }
    this.planted = {
      number: settings.ownTrees,
      orders: problem || faults.length > 0 ? "" : (this.asked ?? ""),
    };
    this.show(
      trees,
      problem
        ? {
            at: "refused",
            title: problem.title,
            hint: problem.hint,
            final: problem instanceof CannotGrow,
          }
        : this.plantedState(trees),
    );
  }

  private show(trees: readonly Individual[], growth: GrowthState): void {
    const { state } = this.store;
    batch(() => {
      if (trees.length > 0 || state.individuals.length > 0) state.individuals = trees;
      state.growth = growth;
    });
  }

  /** How many trees of the forest are trees of their own. */
  private plantedState(trees: readonly Individual[]): GrowthState {
    const { settings, state } = this.store;
    const { inventory } = state;
    const stems = inventory === "loading" ? [] : (inventory?.stems ?? null);
    const sizes: Size[] = stems
      ? stems.map((stem) => sizeOfStem(stem, settings.form))
      : sizesOfForest(this.catalogue.builtinTrees, settings);
    const nearest = nearestIndividual(trees);
    const shown = sizes.filter((size) => nearest(size) !== null).length;
    return { at: "planted", trees: trees.length, shown, all: sizes.length };
  }
}

const textOf = (orders: readonly Order[]): string => (orders.length === 0 ? "" : JSON.stringify(orders));
