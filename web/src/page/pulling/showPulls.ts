/** Hands the pulled trees to the scene, with the displacements that their modes do not show. */

import type { ShownPull } from "galewood/trees";
import type { Forest } from "../../scene/forest";
import type { ForestClient } from "../forest/forestClient";

/** Call when new poses have arrived. */
export function showPulls(forest: Forest, { pulled, pullFields }: ForestClient): void {
  for (const [group, { forest: species }] of forest.moving.entries()) {
    const own = pulled.filter(({ at }) => at.group === group);
    species.showPulls(
      own.flatMap(({ at, table, vertex, force_N }): ShownPull[] => {
        const field = pullFields.get(table, vertex);
        const [x, z] = species.instances.placement.subarray(4 * at.tree);
        return field ? [{ x, z, force_N, field }] : [];
      }),
    );
  }
}
