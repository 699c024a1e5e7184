import { type TreeMeshes, writeGlb } from "./glb";
import { leafMesh } from "./growth/foliage";
import { growSkeleton } from "./growth/growth";
import { type SkeletonNode, scaleToHeight, setGirth, skeletonJson } from "./growth/skeleton";
import type { SurfaceMesh } from "./growth/surface";
import { growTwigs } from "./growth/twigs";
import { woodMesh } from "./growth/wood";
import { barkPictures } from "./pictures/bark-picture";
import { leafPicture, sprayPicture } from "./pictures/leaf-picture";
import { encodePng } from "./pictures/picture";
import type { Species } from "./species";

export interface GrownSpecies extends TreeMeshes {
  glb: Uint8Array;
  skeleton: string;
  nodes: readonly SkeletonNode[];
}

const BARK_WIDTH = 384;
const BARK_HEIGHT = 768;

/** Rounds in which the height of the wood is found at which the leaves end at the height of the tree. */
const ROUND_COUNT = 4;

interface Grown extends TreeMeshes {
  nodes: SkeletonNode[];
}

function topOf({ positions }: SurfaceMesh): number {
  return positions.reduce((top, value, i) => (i % 3 === 1 ? Math.max(top, value) : top), 0);
}

/** The tree with its wood of this height. */
function atHeight(species: Species, wood_height_m: number): Grown {
  const { habit, girth, cut, foliage } = species;
  const nodes = growSkeleton(habit);
  scaleToHeight(nodes, wood_height_m);
  setGirth(nodes, girth);
  const twigs = growTwigs(nodes, species.twigs, habit.seed);
  const leaves = leafMesh(twigs.axes, foliage, habit.seed);
  return { nodes, wood: woodMesh(nodes, cut), twigs: twigs.mesh, leaves };
}

/** The tree in metres; its topmost leaf is at the height of the species. */
function growTree(species: Species): Grown {
  let height_m = 0.94 * species.height_m;
  let grown = atHeight(species, height_m);
  for (let round = 0; round < ROUND_COUNT; round++) {
    height_m += species.height_m - Math.max(...[grown.wood, grown.twigs, grown.leaves].map(topOf));
    grown = atHeight(species, height_m);
  }
  return grown;
}

/** The picture of the sprays of a species, which browsers draw near the eye in place of its leaf cards, as PNG. */
export function drawSprays({ leaf, habit }: Species): Uint8Array {
  return encodePng(sprayPicture(leaf, habit.seed), false);
}

/** Grows a species: the same parameters give the same bytes. */
export async function growSpecies(species: Species): Promise<GrownSpecies> {
  const { nodes, ...meshes } = growTree(species);
  const bark = barkPictures(species.bark, BARK_WIDTH, BARK_HEIGHT, species.barkRelief);
  const pictures = {
    bark: encodePng(bark.colour, true),
    barkNormal: encodePng(bark.normal, true),
    leaves: encodePng(leafPicture(species.leaf, species.habit.seed), false),
  };
  const glb = await writeGlb(species.id, meshes, species.twigs.colour, pictures);
  return { glb, skeleton: skeletonJson(species.id, nodes), nodes, ...meshes };
}
