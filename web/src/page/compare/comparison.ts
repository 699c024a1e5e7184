/** Opens the comparison with the reference solution; its view is loaded when it is first opened. */

import "./compare.css";
import type { SpeciesForest } from "galewood/trees";
import { tool } from "../controls/tools";
import type { World } from "../forest/world";
import { localError_m } from "../overlays/localError";
import type { TreePicker } from "../picking/treePicker";
import { findService } from "../server/api";
import type { Catalogue } from "../server/catalogue";
import { loadPart, withServer } from "../server/connected";
import type { Store } from "../store/store";
import type { Candidate, CompareView } from "./compareView";

export class Comparison {
  readonly tool = tool("compare", "Check accuracy", () => void this.open());
  /** Error of each node, m, by the table's hash, from the last comparison. */
  readonly errors = new Map<string, Float32Array>();
  private view: CompareView | null = null;

  constructor(
    private readonly store: Store,
    private readonly world: World,
    private readonly catalogue: Catalogue,
    private readonly picker: TreePicker,
  ) {}

  async open(): Promise<void> {
    await withServer("The accuracy was not checked.", async () => {
      const view = await loadPart(() => import("./compareView"));
      await findService();
      this.show(view);
    });
  }

  /** The forest stops meanwhile, to leave the processor to the comparison. */
  private show(view: typeof import("./compareView")): void {
    const { state } = this.store;
    const { forest, client } = this.world;
    this.view ??= new view.CompareView({
      candidates: () => forest.moving.flatMap((group) => this.candidate(group.asset.id, group.forest)),
      wind: () => client.wind && { state: client.wind.state, time_s: client.time_s },
      compared: (motion, tracks) => this.errors.set(motion.sha256, localError_m(motion, tracks)),
      closed: () => {
        state.asleep = false;
      },
    });
    state.asleep = true;
    this.view.open(this.picker.selected?.treeId ?? null);
  }

  /** A candidate for the comparison, at the place of the picked tree or of the first of its species. */
  private candidate(id: string, { model, instances }: SpeciesForest): Candidate[] {
    const tree = this.catalogue.find(id)?.tree;
    const motion = this.catalogue.leafMotion(id);
    if (!tree || !motion) return [];
    const picked = this.picker.selected?.treeId === id ? (this.picker.moving?.tree ?? 0) : 0;
    const [x_m, z_m, yaw_rad] = instances.placement.subarray(4 * picked, 4 * picked + 3);
    return [{ tree, model, motion, place: { x_m, z_m, yaw_rad } }];
  }
}
