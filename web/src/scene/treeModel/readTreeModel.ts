/** The page's reader of meshes: a normalised GLB with what it draws in addition: trees that lack limbs, bare trees, flares, collars. */

import { hashUnit } from "galewood/random";
import type { Components } from "galewood/trees";
import {
  type AddedPart,
  limbsOf,
  nearRank,
  type ReadPart,
  rankedIndex,
  readParts,
  type SingleLeaves,
  type TreeModel,
  type TreePart,
} from "galewood/trees";
import { BufferAttribute, type MeshStandardMaterial, type Texture } from "three";
import { addedWood, evenColour } from "./addedWood";
import { bareShoots, type CardMesh } from "./bareShoots";
import { leafSprays, SPRAY_VERTICES } from "./leafSprays";
import { limbKeysOf, pieceKeys } from "./limbKeys";
import type { OpenedTree } from "./openTree";
import { dot, type Point, plus, unit } from "./points";
import { placedSprays, sprayShapes } from "./singleLeaves";
import { skyVisibility } from "./skyVisibility";
import type { DrawnSprays } from "./sprayTiles";

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

/** Share of a leaf card that its picture covers with leaves: in those of the built-in species 0.16 to 0.47. */
const PICTURE_COVER = 0.3;
/** Share of the sky that the outside of a crown sees, which counts as open. */
const OUTSIDE_SKY = 0.8;

/** Tells every vertex how open to the sky it is. */
function assignOpenness(read: readonly ReadPart[]): void {
  const leaves = read.filter(({ part }) => part.kind === "leaves");
  const seenFrom = skyVisibility(
    leaves.map(({ part: { position, material }, geometry: { index } }) => ({
      positions: position.array,
      index,
      cover: material.alphaTest > 0 || material.transparent ? PICTURE_COVER : 1,
    })),
  );
  for (const { part } of read) {
    const seen = seenFrom(part.position.array);
    seen.forEach((share, v) => {
      part.piece.setY(v, Math.min(1, share / OUTSIDE_SKY));
    });
  }
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

/** A part made of the cards of another: what is known of each of its vertices. */
interface OfCards {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly index: Uint32Array;
  /** The card's first vertex, whose node it shares. */
  readonly card: Uint32Array;
  /** The point to which its twig or spray shrinks. */
  readonly bases: Float32Array;
}

/** `rankOf`, `numberOf`: rank and random number of the piece of a vertex, which is on this card. */
function partOfCards(
  { part }: ReadPart,
  { positions, normals, index, card, bases }: OfCards,
  look: Pick<TreePart, "kind" | "material" | "uv" | "colour">,
  rankOf: RankOf,
  numberOf: (vertex: number, card: number) => number = (_, v) => part.piece.getX(v),
): TreePart {
  const vertices = card.length;
  const piece = new Float32Array(4 * vertices);
  const anchor = new Float32Array(4 * vertices);
  const ranks = new Float32Array(vertices);
  const free = look.kind === "leaves" ? 1 : 0;
  for (let k = 0; k < vertices; k++) {
    const v = card[k];
    ranks[k] = rankOf(k, v);
    piece.set([numberOf(k, v), part.piece.getY(v), free, ranks[k]], 4 * k);
    anchor.set([bases[3 * k], bases[3 * k + 1], bases[3 * k + 2], part.anchor.getW(v)], 4 * k);
  }
  const ranked = rankedIndex(index, (v) => ranks[v]);
  return {
    ...look,
    vertices,
    normal: new BufferAttribute(normals, 3),
    position: new BufferAttribute(positions, 3),
    anchor: new BufferAttribute(anchor, 4),
    piece: new BufferAttribute(piece, 4),
    hold: card,
    index: new BufferAttribute(ranked.index, 1),
    counts: ranked.counts,
  };
}

const cardMesh = ({ part, geometry }: ReadPart): CardMesh => ({
  positions: part.position.array as Float32Array,
  first: cardsOf(geometry.pieces),
});

type RankOf = (vertex: number, card: number) => number;

/** A part of wood in the colour of the twigs for each part of leaves; none for trees without drawn twigs. */
function twiggy(
  read: readonly ReadPart[],
  meshOf: (leaves: ReadPart) => OfCards & { rankOf: RankOf },
): AddedPart[] {
  const twigs = read.find(({ geometry }) => geometry.kind === "twigs")?.part;
  if (!twigs) return [];
  return read.flatMap((leaves, of): AddedPart[] => {
    if (leaves.part.kind !== "leaves") return [];
    const { rankOf, ...mesh } = meshOf(leaves);
    const colour = evenColour(twigs.colour, mesh.card.length);
    const look = { kind: "wood", material: twigs.material, uv: null, colour } as const;
    return [{ part: partOfCards(leaves, mesh, look, rankOf), of }];
  });
}

/** Shoots in place of leaf cards. */
const barePartsOf = (read: readonly ReadPart[]): AddedPart[] =>
  twiggy(read, (leaves) => {
    const { ranks, ...shoots } = bareShoots(cardMesh(leaves));
    return { ...shoots, rankOf: (vertex) => ranks[vertex] };
  });

/** Sprays in place of leaf cards, and the shoots that bear them. */
function nearPartsOf(read: readonly ReadPart[], material: MeshStandardMaterial): AddedPart[] {
  const ranksOf =
    ({ part }: ReadPart): RankOf =>
    (_, card) =>
      nearRank(part.piece.getW(card));
  const stems = twiggy(read, (leaves) => {
    const { ranks: _, ...shoots } = bareShoots(cardMesh(leaves), 1);
    return { ...shoots, rankOf: ranksOf(leaves) };
  });
  const sprays = read.flatMap((leaves, of): AddedPart[] => {
    if (leaves.part.kind !== "leaves") return [];
    const { uvs, ...mesh } = leafSprays(cardMesh(leaves));
    const { colour, normal } = leaves.part;
    const look = {
      kind: "leaves",
      material,
      uv: new BufferAttribute(uvs, 2),
      colour: colour && ofCards(colour, mesh.card),
    } as const;
    const normals = crownNormals(mesh, normal);
    return [{ part: partOfCards(leaves, { ...mesh, normals }, look, ranksOf(leaves), sprayNumber), of }];
  });
  return [...stems, ...sprays];
}

/** The leaves one by one; null unless they are the cards of one part. */
function singlesOf(
  read: readonly ReadPart[],
  material: MeshStandardMaterial,
  drawn: DrawnSprays,
): SingleLeaves | null {
  const [leaves, another] = read.filter((one) => one.part.kind === "leaves");
  if (!leaves || another) return null;
  const { part } = leaves;
  const point = (values: BufferAttribute, v: number): Point => [
    values.getX(v),
    values.getY(v),
    values.getZ(v),
  ];
  const { card, ...placed } = placedSprays(cardMesh(leaves), {
    crown: (v) => point(part.normal, v),
    colour: (v) => (part.colour ? point(part.colour, v) : [1, 1, 1]),
    openness: (v) => part.piece.getY(v),
    limb: (v) => part.anchor.getW(v),
  });
  const before = read.slice(0, read.indexOf(leaves)).reduce((sum, one) => sum + one.part.vertices, 0);
  return { ...placed, material, shapes: sprayShapes(drawn), hold: card.map((v) => before + v) };
}

/** The material of the leaves with another picture; null for a tree without leaves. */
function spraysMaterial(parts: readonly TreePart[], picture: Texture): MeshStandardMaterial | null {
  const material = parts.find(({ kind }) => kind === "leaves")?.material.clone() ?? null;
  if (material) {
    material.map = picture;
    material.userData = {};
  }
  return material;
}

const sprayNumber = (vertex: number) => hashUnit(Math.floor(vertex / SPRAY_VERTICES), 3);

/** Each vertex has the value of its card. */
function ofCards(values: BufferAttribute, card: Uint32Array): BufferAttribute {
  const { itemSize, array } = values;
  const own = new Float32Array(itemSize * card.length);
  card.forEach((v, k) => {
    for (let c = 0; c < itemSize; c++) own[itemSize * k + c] = array[itemSize * v + c];
  });
  return new BufferAttribute(own, itemSize);
}

/** Weight of a spray's own direction beside that of the crown at its card. */
const OWN_NORMAL_WEIGHT = 0.5;

/** Normals between those of the sprays and that of the crown, towards whose side they face. */
function crownNormals({ normals, card }: OfCards, crown: BufferAttribute): Float32Array {
  const mixed = new Float32Array(normals.length);
  card.forEach((v, k) => {
    const round: Point = [crown.getX(v), crown.getY(v), crown.getZ(v)];
    const own: Point = [normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]];
    const weight = OWN_NORMAL_WEIGHT * (dot(own, round) < 0 ? -1 : 1);
    mixed.set(unit(plus(round, own, weight)), 3 * k);
  });
  return mixed;
}

/** What is known of a tree besides its file. */
export interface TreeKind {
  /** A built-in tree: each instance lacks some limbs, leans, and has a root flare and branch collars. */
  readonly varied: boolean;
  readonly evergreen: boolean;
}

/** Reads an opened tree; throws if it contains no mesh. */
export function readTreeModel(
  { scene, sprays, drawn }: OpenedTree,
  { varied, evergreen }: TreeKind,
): TreeModel {
  const { read, height_m, radius_m } = readParts(scene);
  if (varied) assignKeys(read);
  assignOpenness(read);
  const parts = read.map(({ part }) => part);
  for (const { kind, material } of parts) material.userData.shoots = varied && kind === "leaves";
  const ofSprays = sprays && spraysMaterial(parts, sprays);
  let bareParts: AddedPart[] | null = null;
  let nearParts: AddedPart[] | null = null;
  let singles: SingleLeaves | null | undefined;
  return {
    parts,
    materials: [...parts.map(({ material }) => material), ...(ofSprays ? [ofSprays] : [])],
    get bare() {
      bareParts ??= barePartsOf(read);
      return bareParts;
    },
    added: varied ? addedWood(read, evergreen) : [],
    get near() {
      nearParts ??= ofSprays ? nearPartsOf(read, ofSprays) : [];
      return nearParts;
    },
    get singles() {
      if (singles === undefined) singles = ofSprays && drawn ? singlesOf(read, ofSprays, drawn) : null;
      return singles;
    },
    leans: varied,
    evergreen,
    height_m,
    radius_m,
  };
}
