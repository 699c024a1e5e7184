import type { TreeMeshes } from "../glb";
import type { Species } from "../species";
import { leafMesh } from "./foliage";
import { growSkeleton } from "./growth";
import { type SkeletonNode, scaleToHeight, setGirth } from "./skeleton";
import type { SurfaceMesh } from "./surface";
import { growTwigs } from "./twigs";
import { woodMesh } from "./wood";

export interface GrownTree extends TreeMeshes {
  nodes: SkeletonNode[];
}

/** Rounds in which the height of the wood is found at which the leaves end at the height of the tree. */
const ROUND_COUNT = 4;

function topOf({ positions }: SurfaceMesh): number {
  return positions.reduce((top, value, i) => (i % 3 === 1 ? Math.max(top, value) : top), 0);
}

/** The tree with its wood of this height. */
function atHeight(species: Species, wood_height_m: number): GrownTree {
  const { habit, girth, cut, foliage } = species;
  const nodes = growSkeleton(habit);
  scaleToHeight(nodes, wood_height_m);
  setGirth(nodes, girth);
  const twigs = growTwigs(nodes, species.twigs, habit.seed);
  const leaves = leafMesh(twigs.axes, foliage, habit.seed);
  return { nodes, wood: woodMesh(nodes, cut), twigs: twigs.mesh, leaves };
}

/**
 * The tree in metres; its topmost leaf is at the height of the species. `refined` may change the parameters after each
 * round, from the tree that they gave.
 */
export function growTree(
  species: Species,
  refined: (species: Species, grown: GrownTree) => Species = (same) => same,
): GrownTree {
  let height_m = 0.94 * species.height_m;
  let [now, grown] = [species, atHeight(species, height_m)];
  for (let round = 0; round < ROUND_COUNT; round++) {
    height_m += species.height_m - Math.max(...[grown.wood, grown.twigs, grown.leaves].map(topOf));
    now = refined(now, grown);
    grown = atHeight(now, height_m);
  }
  return grown;
}
