/**
 * The page's reading of meshes: parts with what is drawn in addition: keys of the limbs that trees lack, openness to the sky, flares,
 * collars, dead branches. Pure: the worker of trees.worker.ts does it.
 */
import { limbsOf, type MeshArrays, type ReadMeshes, type ReadPart, readMeshes } from "galewood/trees";
import { limbKeysOf, pieceKeys } from "./limbKeys";
import { skyVisibility } from "./skyVisibility";
import { type AddedArrays, addedWood } from "./wood/addedWood";

/** What is known of a tree besides its file. */
export interface TreeKind {
  /** A built-in tree: each instance lacks some limbs, leans, and has a root flare and branch collars. */
  readonly varied: boolean;
  readonly evergreen: boolean;
}

export interface TreeMesh extends MeshArrays {
  /** Whether a picture cuts shapes out of the triangles. */
  readonly cutOut: boolean;
}

export interface ReadTree extends ReadMeshes {
  readonly added: readonly AddedArrays[];
}

/** Gives every limb its key, so that trees can lack it. */
function assignKeys(read: readonly ReadPart[]): void {
  const limbs = limbsOf(read.map(({ geometry }) => geometry));
  const keys = limbKeysOf(1 + limbs.reduce((most, limb) => limb.reduce((a, b) => Math.max(a, b), most), -1));
  read.forEach(({ part, geometry }, k) => {
    const ofPiece = pieceKeys(limbs[k], keys);
    geometry.pieces.ofVertex.forEach((piece, v) => {
      part.anchors[4 * v + 3] = ofPiece[piece];
    });
  });
}

/** Share of a leaf card that its picture covers with leaves: in those of the built-in species 0.16 to 0.47. */
const PICTURE_COVER = 0.3;
/** Share of the sky that the outside of a crown sees, which counts as open. */
const OUTSIDE_SKY = 0.8;

/** Tells every vertex how open to the sky it is. */
function assignOpenness(read: readonly ReadPart[], meshes: readonly TreeMesh[]): void {
  const crown = read.flatMap(({ part, geometry: { positions, index } }, k) => {
    const cover = meshes[k].cutOut ? PICTURE_COVER : 1;
    return part.kind === "leaves" ? [{ positions, index, cover }] : [];
  });
  const seenFrom = skyVisibility(crown);
  for (const { part } of read) {
    seenFrom(part.positions).forEach((share, v) => {
      part.pieces[4 * v + 1] = Math.min(1, share / OUTSIDE_SKY);
    });
  }
}

/** Reads the meshes of a tree, in table order. */
export function readTree(meshes: readonly TreeMesh[], { varied, evergreen }: TreeKind): ReadTree {
  const tree = readMeshes(meshes);
  if (varied) assignKeys(tree.read);
  assignOpenness(tree.read, meshes);
  return { ...tree, added: varied ? addedWood(tree.read, evergreen) : [] };
}
