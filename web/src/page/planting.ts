/** Plants the forest: places the trees of the catalogue and sends them to the worker. */

import { clearingPlace } from "../scene/clearing";
import { type Forest, type PlacedSpecies, placedSpecies, placeForest, type TreeAsset } from "../scene/forest";
import { woodReach_m } from "../scene/placement";
import type { Stage } from "../scene/stage";
import { placeStand, type Stand } from "../scene/stand";
import type { ClientGroup, ForestClient } from "./forestClient";
import type { InventoryForest } from "./inventory/inventoryForest";
import { isRecorded } from "./paper/paperState";
import type { Catalogue } from "./server/catalogue";
import { momentFrom } from "./settings/link";
import { plantedAs } from "./settings/planted";
import type { Settings } from "./settings/settings";
import { placementOf, sharedFrom } from "./settings/sharedForest";

/**
 * Places the trees: built-in ones and uploads that are planted among them share the forest, and every planted upload
 * stands in the clearing. Uploads that are still loading take no places, so that the forest has no gaps.
 */
export function plantForest(
  assets: readonly TreeAsset[],
  settings: Settings,
  stand: PlantedStand | null = null,
): PlacedSpecies[] {
  const how = (asset: TreeAsset) => (asset.builtin || !asset.model ? null : plantedAs(settings, asset.id));
  const only = assets.some((asset) => how(asset) === "only");
  const uploads = Object.keys(settings.planted);
  const single = Object.fromEntries(uploads.map((id, k) => [id, clearingPlace(k)]));
  if (stand) {
    const places = placeStand(assets, stand, { form: settings.form, named: stand.named });
    return placedSpecies(assets, (asset) => places.get(asset) ?? [], single, settings.season);
  }
  return placeForest(assets, settings.trees, settings.forestSeed, {
    ...settings,
    grows: (asset) => (only ? how(asset) === "only" : asset.builtin || how(asset) === "more"),
    single,
  });
}

/** The stems of an inventory, and the uploads that have the names of species in it. */
export interface PlantedStand extends Stand {
  named(species: string): string | null;
}

/** Around a stand from an inventory the invented forest begins this far from its edge. */
const OPEN_LAND_M = 130;

const NO_INVENTORY = { current: null, loading: false };

export class Planting {
  /** Id of the shared forest; null while the forest is private. */
  share = sharedFrom(location.search);
  /** Whether the trees are to be replaced for all once those that are loading have arrived. */
  private owed = false;
  /** Time at which the forest starts. */
  readonly from_s = momentFrom(location.search).time_s ?? 0;

  /** `shown` is called when the trees of a plan have appeared. */
  constructor(
    private readonly settings: Settings,
    private readonly stage: Stage,
    private readonly forest: Forest,
    private readonly client: ForestClient,
    private readonly catalogue: Catalogue,
    private readonly shown: () => void,
    private readonly inventory: Pick<InventoryForest, "current" | "loading"> = NO_INVENTORY,
  ) {}

  /**
   * Places the trees. Existing ones keep moving, new ones appear with their first poses. `replant`: also for all who
   * share the forest.
   */
  place(replant = false): void {
    const { settings, share } = this;
    this.owed ||= replant;
    // A shared forest keeps the trees of the first request, so that must not lack species that are still loading.
    if (share !== null && !this.catalogue.isLoaded) return;
    if (this.inventory.loading) return;
    const { stand } = this;
    const placed = plantForest(this.catalogue.assets, settings, stand);
    this.client.plan(
      placed.flatMap((group) => this.clientGroup(group)),
      {
        lookup: settings.lookup,
        method: settings.method,
        poseEasing: settings.poseEasing,
        from_s: this.from_s,
        share: share === null ? null : { id: share, replant: this.owed, about: placementOf(settings) },
      },
      settings.wind,
      () => {
        this.forest.show(placed);
        this.stage.surround({
          edge_m: woodReach_m(placed.map(({ instances }) => instances.placement)) + (stand ? OPEN_LAND_M : 0),
          seed: settings.forestSeed,
          density: settings.density,
          shares: { ...settings.shares },
          assets: this.catalogue.assets,
        });
        this.stage.shelter(this.forest.crowns);
        this.shown();
      },
    );
    this.owed = false;
  }

  /** The stand of the inventory; null without one. */
  private get stand(): PlantedStand | null {
    const { current } = this.inventory;
    if (!current) return null;
    const named = (species: string) => this.catalogue.uploadNamed(species);
    return { stems: current.stems, perHa: current.report.per_ha, named };
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
    return isRecorded(this.share === null ? known : { ...known, motion: this.catalogue.leafMotion(id) });
  }
}
