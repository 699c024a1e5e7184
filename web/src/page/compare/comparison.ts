/** Opens the comparison with the reference solution; its view is loaded when it is first opened. */

import type { SpeciesForest } from "galewood/trees";
import type { Forest } from "../../scene/forest";
import type { ForestClient } from "../forestClient";
import { localError_m } from "../overlays/localError";
import type { Catalogue } from "../server/catalogue";
import type { TreePicker } from "../treePicker";
import type { Candidate, CompareView } from "./compareView";

export class Comparison {
  private view: CompareView | null = null;
  /** Error of each node, m, by the table's hash, from the last comparison. */
  readonly errors = new Map<string, Float32Array>();

  /** `busy` is called with true when the comparison opens, and with false when it closes. */
  constructor(
    private readonly forest: Forest,
    private readonly client: ForestClient,
    private readonly catalogue: Catalogue,
    private readonly picker: TreePicker,
    private readonly busy: (busy: boolean) => void,
  ) {}

  async open(): Promise<void> {
    const view = await import("./compareView");
    this.view ??= new view.CompareView({
      candidates: () => this.forest.moving.flatMap(({ asset, forest }) => this.candidate(asset.id, forest)),
      wind: () => this.client.wind && { state: this.client.wind.state, time_s: this.client.time_s },
      compared: (motion, tracks) => this.errors.set(motion.sha256, localError_m(motion, tracks)),
      closed: () => this.busy(false),
    });
    this.busy(true);
    this.view.open(this.picker.figures?.treeId ?? null);
  }

  /** A candidate for the comparison, at the place of the picked tree or of the first of its species. */
  private candidate(id: string, { model, instances }: SpeciesForest): Candidate[] {
    const tree = this.catalogue.find(id)?.tree;
    const motion = this.catalogue.leafMotion(id);
    if (!tree || !motion) return [];
    const picked = this.picker.figures?.treeId === id ? (this.picker.moving?.tree ?? 0) : 0;
    const [x_m, z_m, yaw_rad] = instances.placement.subarray(4 * picked, 4 * picked + 3);
    return [{ tree, model, motion, place: { x_m, z_m, yaw_rad } }];
  }

  dispose(): void {
    this.view?.dispose();
  }
}
