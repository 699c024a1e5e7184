import { type TreeMeshes, writeGlb } from "./glb";
import { type SkeletonNode, skeletonJson } from "./growth/skeleton";
import { growTree } from "./growth/tree";
import { barkPictures } from "./pictures/bark-picture";
import { drawnSprays, fullerPicture, leafPicture, sprayPicture } from "./pictures/leaf-picture";
import { encodePng } from "./pictures/picture";
import type { Species } from "./species";

export interface GrownSpecies extends TreeMeshes {
  glb: Uint8Array;
  skeleton: string;
  nodes: readonly SkeletonNode[];
}

const BARK_WIDTH = 384;
const BARK_HEIGHT = 768;

/** The picture of the sprays of a species, which browsers draw near the eye in place of its leaf cards, as PNG. */
export function drawSprays({ leaf, habit }: Species): Uint8Array {
  return encodePng(sprayPicture(leaf, habit.seed), false);
}

/** What that picture shows, as JSON; null for needles. */
export function describeSprays({ leaf, habit, foliage }: Species): string | null {
  const drawn = drawnSprays(leaf, habit.seed, foliage.size_m);
  return drawn && `${JSON.stringify(drawn)}\n`;
}

/** The picture of the shoots that browsers draw on the leaf cards, as PNG; null: they draw those of the mesh. */
export function drawShoots({ leaf, habit }: Species): Uint8Array | null {
  const picture = fullerPicture(leaf, habit.seed);
  return picture && encodePng(picture, false);
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
