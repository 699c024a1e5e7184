import { barkPictures } from "./bark-picture";
import { leafMesh } from "./foliage";
import { writeGlb } from "./glb";
import { growSkeleton } from "./growth";
import { leafPicture } from "./leaf-picture";
import { encodePng } from "./picture";
import { type SkeletonNode, scaleToHeight, setGirth, skeletonJson } from "./skeleton";
import type { Species } from "./species";
import type { SurfaceMesh } from "./surface";
import { woodMesh } from "./wood";

export interface GrownSpecies {
  glb: Uint8Array;
  skeleton: string;
  nodes: readonly SkeletonNode[];
  wood: SurfaceMesh;
  leaves: SurfaceMesh;
}

const BARK_WIDTH = 384;
const BARK_HEIGHT = 768;

/** The skeleton of a species in metres with its radii. */
export function growNodes(species: Species): SkeletonNode[] {
  const nodes = growSkeleton(species.habit);
  scaleToHeight(nodes, species.height_m);
  setGirth(nodes, species.girth);
  return nodes;
}

/** Grows a species: the same parameters give the same bytes. */
export async function growSpecies(species: Species): Promise<GrownSpecies> {
  const nodes = growNodes(species);
  const wood = woodMesh(nodes, species.cut);
  const leaves = leafMesh(nodes, species.foliage, species.habit.seed);
  const bark = barkPictures(species.bark, BARK_WIDTH, BARK_HEIGHT, species.barkRelief);
  const pictures = {
    bark: encodePng(bark.colour, true),
    barkNormal: encodePng(bark.normal, true),
    leaves: encodePng(leafPicture(species.leaf, species.habit.seed), false),
  };
  const glb = await writeGlb(species.id, wood, leaves, pictures);
  return { glb, skeleton: skeletonJson(species.id, nodes), nodes, wood, leaves };
}
