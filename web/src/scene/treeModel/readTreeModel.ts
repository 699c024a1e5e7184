/** The page's reader of meshes: a normalised GLB with what it draws in addition, trees that lack limbs and bare trees. */

import type { Components } from "galewood/trees";
import {
  type BarePart,
  limbsOf,
  type ReadPart,
  rankedIndex,
  readParts,
  type TreeModel,
  type TreePart,
} from "galewood/trees";
import { BufferAttribute, type Object3D } from "three";
import { bareShoots } from "./bareShoots";
import { limbKeysOf, pieceKeys } from "./limbKeys";
import { meanColour } from "./meanColour";

/** Vertices that all have the mean of other colours. */
function evenColour(of: BufferAttribute | null, vertices: number): BufferAttribute | null {
  const mean = meanColour(of);
  if (!mean) return null;
  return new BufferAttribute(
    Float32Array.from({ length: 3 * vertices }, (_, i) => mean[i % 3]),
    3,
  );
}

/** Gives every limb its key, so that trees can lack it. */
function assignKeys(read: readonly ReadPart[]): void {
  const limbs = limbsOf(read.map(({ geometry }) => geometry));
  const keys = limbKeysOf(1 + limbs.reduce((most, limb) => limb.reduce((a, b) => Math.max(a, b), most), -1));
  read.forEach(({ part, geometry }, k) => {
    const ofPiece = pieceKeys(limbs[k], keys);
    const anchor = part.anchor.array as Float32Array;
    geometry.pieces.ofVertex.forEach((piece, v) => {
      anchor[4 * v + 3] = ofPiece[piece];
    });
  });
}

/** First vertices of the leaves that are cards of four vertices. */
function cardsOf({ ofVertex, count }: Components): Uint32Array {
  const sizes = new Uint32Array(count);
  const first = new Uint32Array(count).fill(ofVertex.length);
  ofVertex.forEach((piece, v) => {
    sizes[piece]++;
    first[piece] = Math.min(first[piece], v);
  });
  return first.filter((_, piece) => sizes[piece] === 4);
}

/** Shoots in place of leaf cards, in the colour of the twigs; none for trees without drawn twigs. */
function barePartsOf(read: readonly ReadPart[]): BarePart[] {
  const twigs = read.find(({ geometry }) => geometry.kind === "twigs");
  return read.flatMap(({ part, geometry }, of): BarePart[] => {
    if (part.kind !== "leaves" || !twigs) return [];
    const positions = part.position.array as Float32Array;
    const shoots = bareShoots({ positions, first: cardsOf(geometry.pieces) });
    const vertices = shoots.card.length;
    const piece = new Float32Array(4 * vertices);
    const anchor = new Float32Array(4 * vertices);
    shoots.card.forEach((v, k) => {
      piece.set([part.piece.getX(v), part.piece.getY(v), 0, shoots.ranks[k]], 4 * k);
      anchor.set([...shoots.bases.subarray(3 * k, 3 * k + 3), part.anchor.getW(v)], 4 * k);
    });
    const ranked = rankedIndex(shoots.index, (v) => shoots.ranks[v]);
    const bare: TreePart = {
      kind: "wood",
      vertices,
      material: twigs.part.material,
      normal: new BufferAttribute(shoots.normals, 3),
      uv: null,
      colour: evenColour(twigs.part.colour, vertices),
      position: new BufferAttribute(shoots.positions, 3),
      anchor: new BufferAttribute(anchor, 4),
      piece: new BufferAttribute(piece, 4),
      hold: shoots.card,
      index: new BufferAttribute(ranked.index, 1),
      counts: ranked.counts,
    };
    return [{ part: bare, of }];
  });
}

/** Reads an opened GLB; throws if it contains no mesh. `varied`: each tree lacks some limbs. */
export function readTreeModel(scene: Object3D, varied = false): TreeModel {
  const { read, height_m, radius_m } = readParts(scene);
  if (varied) assignKeys(read);
  let bareParts: BarePart[] | null = null;
  return {
    parts: read.map(({ part }) => part),
    get bare() {
      bareParts ??= barePartsOf(read);
      return bareParts;
    },
    height_m,
    radius_m,
  };
}
