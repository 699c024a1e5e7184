/** The page's reader of meshes: a normalised GLB with what it draws in addition: trees that lack limbs, bare trees, root flares. */

import type { Components } from "galewood/trees";
import {
  type AddedPart,
  COMMON_KEY,
  limbsOf,
  type ReadPart,
  rankedIndex,
  readParts,
  type TreeModel,
  type TreePart,
} from "galewood/trees";
import { BufferAttribute, BufferGeometry, type Object3D } from "three";
import { bareShoots } from "./bareShoots";
import { limbKeysOf, pieceKeys } from "./limbKeys";
import { meanColour } from "./meanColour";
import { rootFlare } from "./rootFlare";

/** The flare is drawn until a tree shows about this share of its pieces. */
const FLARE_RANK = 0.3;

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
function barePartsOf(read: readonly ReadPart[]): AddedPart[] {
  const twigs = read.find(({ geometry }) => geometry.kind === "twigs");
  return read.flatMap(({ part, geometry }, of): AddedPart[] => {
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

/** The flare at the foot of the stem; none for trees whose stem has no round base. */
function flareOf(read: readonly ReadPart[]): AddedPart[] {
  const of = read.findIndex((one) => one.geometry.kind === "wood");
  if (of < 0) return [];
  const { part, geometry } = read[of];
  const uvs = (part.uv?.array as Float32Array | undefined) ?? null;
  const positions = part.position.array as Float32Array;
  const flare = rootFlare({ positions, uvs, index: geometry.index });
  if (!flare) return [];
  const vertices = flare.hold.length;
  const piece = new Float32Array(4 * vertices);
  const anchor = new Float32Array(4 * vertices);
  flare.hold.forEach((v, k) => {
    piece.set([part.piece.getX(v), part.piece.getY(v), 0, FLARE_RANK], 4 * k);
    anchor.set([0, 0, 0, COMMON_KEY], 4 * k);
  });
  const bent = new BufferGeometry();
  bent.setAttribute("position", new BufferAttribute(flare.positions, 3));
  bent.setIndex(new BufferAttribute(flare.index, 1));
  bent.computeVertexNormals();
  const ranked = rankedIndex(flare.index, () => FLARE_RANK);
  const added: TreePart = {
    ...part,
    vertices,
    normal: bent.getAttribute("normal") as BufferAttribute,
    uv: flare.uvs && new BufferAttribute(flare.uvs, 2),
    colour: evenColour(part.colour, vertices),
    position: new BufferAttribute(flare.positions, 3),
    anchor: new BufferAttribute(anchor, 4),
    piece: new BufferAttribute(piece, 4),
    hold: flare.hold,
    index: new BufferAttribute(ranked.index, 1),
    counts: ranked.counts,
  };
  return [{ part: added, of }];
}

/** Reads an opened GLB; throws if it contains no mesh. `varied`: a built-in tree: each instance lacks some limbs, and has a root flare. */
export function readTreeModel(scene: Object3D, varied = false): TreeModel {
  const { read, height_m, radius_m } = readParts(scene);
  if (varied) assignKeys(read);
  let bareParts: AddedPart[] | null = null;
  return {
    parts: read.map(({ part }) => part),
    get bare() {
      bareParts ??= barePartsOf(read);
      return bareParts;
    },
    added: varied ? flareOf(read) : [],
    height_m,
    radius_m,
  };
}
