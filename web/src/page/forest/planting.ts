/** Plants the forest: places the trees of the catalogue and sends them to the worker, again whenever that changes. */

import type { Stem } from "galewood/inventory";
import { clearingPlace } from "../../scene/clearing";
import {
  CENTRE_TREES,
  type PlacedSpecies,
  placedSpecies,
  placeForest,
  type TreeAsset,
} from "../../scene/forest";
import { individualsInstead } from "../../scene/forestIndividuals";
import type { Individual } from "../../scene/individuals";
import { woodReach_m } from "../../scene/placement";
import { placeStand } from "../../scene/stand";
import type { PaperMethod } from "../paper/paperMethod";
import { isRecorded } from "../paper/paperState";
import type { Catalogue } from "../server/catalogue";
import { plantedAs } from "../settings/planted";
import type { Settings } from "../settings/settings";
import { PLACEMENT_KEYS, placementOf } from "../settings/sharedForest";
import { watch } from "../store/signals";
import type { Store } from "../store/store";
import type { ClientGroup } from "./forestClient";
import type { World } from "./world";

/**
 * Places the trees: built-in ones and uploads that are planted among them share the forest, and every planted upload
 * stands in the clearing. Uploads that are still loading take no places, so that the forest has no gaps. `individuals`: the
 * trees grown for this forest, which stand for built-in ones once all are loaded.
 */
export function plantForest(
  assets: readonly TreeAsset[],
  settings: Settings,
  stand: PlantedStand | null = null,
  individuals: readonly Individual[] = [],
): PlacedSpecies[] {
  const how = (asset: TreeAsset) => (asset.builtin || !asset.model ? null : plantedAs(settings, asset.id));
  const only = assets.some((asset) => how(asset) === "only");
  const uploads = Object.keys(settings.planted);
  const single = Object.fromEntries(uploads.map((id, k) => [id, clearingPlace(k)]));
  if (stand) {
    const { stems, named } = stand;
    const places = placeStand(assets, stems, { form: settings.form, named, individuals });
    return placedSpecies(assets, (asset) => places.get(asset) ?? [], single, settings.season);
  }
  return placeForest(assets, settings.trees, settings.forestSeed, {
    ...settings,
    grows: (asset) => (only ? how(asset) === "only" : asset.builtin || how(asset) === "more"),
    single,
    instead: individualsInstead(individuals, assets),
  });
}

/** The stems of an inventory, and the uploads that have the names of species in it. */
export interface PlantedStand {
  readonly stems: readonly Stem[];
  named(species: string): string | null;
}

/** Around a stand from an inventory the invented forest begins this far from its edge. */
const OPEN_LAND_M = 130;

/** Of larger forests the trees in the centre are planted when the first species has arrived, and all when all have. */
const MOST_REPLANTED = 20_000;

/** The first trees are planted together if all arrive within this time of the first one: the forest does not fill up in view. */
const TOGETHER_MS = 800;

export class Planting {
  /** Whether the trees are to be replaced for all once those that are loading have arrived. */
  private owed = false;
  /** Whether trees that move have been planted. */
  private planted = false;
  /** Whether the first trees have not waited for the others yet, do so, or have done so. */
  private patience: "whole" | "waiting" | "over" = "whole";

  constructor(
    private readonly store: Store,
    private readonly world: World,
    private readonly catalogue: Catalogue,
    paper: PaperMethod,
  ) {
    const { settings, state } = store;
    // Another number of own trees changes nothing before these are there.
    const keys = PLACEMENT_KEYS.filter((key) => key !== "ownTrees");
    watch(
      () => [...keys.map((key) => settings[key]), state.share, state.inventory],
      () => this.place(!store.isAdopting),
    );
    watch(
      () => [settings.ownTrees, state.individuals, state.growth] as const,
      ([number, trees, growth], [numberBefore, treesBefore, growthBefore]) => {
        this.owed ||= number !== numberBefore && !store.isAdopting;
        const joins = state.share !== null && growthBefore.at === "growing" && growth.at !== "growing";
        if (trees !== treesBefore || joins) this.place();
      },
    );
    watch(
      () => [
        settings.lookup,
        settings.quality,
        settings.background,
        catalogue.assetChanges.value,
        paper.arrivals.value,
      ],
      () => this.place(),
    );
    // Trees may have arrived before.
    if (catalogue.assets.some(({ model }) => model !== null)) this.place();
  }

  /**
   * Places the trees. Existing ones keep moving, new ones appear with their first poses. `replant`: also for all who
   * share the forest.
   */
  private place(replant = false): void {
    const { settings, state, opened, from_s } = this.store;
    const { inventory, individuals } = state;
    this.owed ||= replant;
    // A shared forest keeps the trees of the first request, so that must not lack species that are still loading.
    if (state.share !== null && !this.catalogue.isLoaded) return;
    // nor trees that are still growing: until these are there, the others move by themselves
    const grows = state.share !== null && state.growth.at === "growing";
    if (grows && this.planted) return;
    const share = grows ? null : state.share;
    if (inventory === "loading") return;
    const large = settings.trees > MOST_REPLANTED || individuals.length > 0;
    const waits = this.planted && large && !this.catalogue.isLoaded;
    if (waits && !replant) return;
    const { isLoaded, order } = this.catalogue;
    if (!this.planted && !isLoaded && !order.awaitsFirst && this.isPatient()) return;
    const named = (species: string) => this.catalogue.uploadNamed(species);
    const stand = inventory && { stems: inventory.stems, named };
    const fromCentre = large && !isLoaded && opened.eye === null; // a link may look at another place
    const trees = fromCentre ? Math.min(CENTRE_TREES, settings.trees) : settings.trees;
    const placed = plantForest(this.catalogue.assets, { ...settings, trees }, stand, individuals);
    this.planted = placed.some(({ motion }) => motion !== null);
    const { lookup, method, poseEasing } = settings;
    this.world.client.plan(
      placed.flatMap((group) => this.clientGroup(group)),
      {
        lookup,
        method,
        poseEasing,
        from_s,
        share: share === null ? null : { id: share, replant: this.owed, about: placementOf(settings) },
      },
      () =>
        this.world.show(placed, {
          edge_m: woodReach_m(placed.map(({ instances }) => instances.placement)) + (stand ? OPEN_LAND_M : 0),
          seed: settings.forestSeed,
          density: settings.density,
          shares: settings.shares,
          assets: this.catalogue.assets,
        }),
    );
    this.world.prepare(placed);
    this.owed &&= grows;
  }

  private isPatient(): boolean {
    if (this.patience === "whole") {
      this.patience = "waiting";
      setTimeout(() => {
        this.patience = "over";
        if (!this.planted) this.place();
      }, TOGETHER_MS);
    }
    return this.patience === "waiting";
  }

  /** The group as the worker needs it; none if its trees have no table. */
  private clientGroup({ asset: { id }, motion, instances }: PlacedSpecies): ClientGroup[] {
    const leafTable = this.catalogue.leafMotion(id)?.sha256 ?? motion?.sha256;
    if (!motion || !leafTable) return [];
    const compliance = this.catalogue.find(id)?.tree.compliance_sha256 ?? null;
    return [{ key: id, motion, leafTable, ...instances, recorded: this.isRecorded(id), compliance }];
  }

  /** Whether the server has the records of the table by which it knows these trees. */
  private isRecorded(id: string): boolean {
    const known = this.catalogue.find(id);
    if (known === null) return false;
    const shared = this.store.state.share !== null;
    return isRecorded(shared ? { ...known, motion: this.catalogue.leafMotion(id) } : known);
  }
}
