/** What is drawn in place of the leaf cards of a tree: shoots in winter, sprays near the eye, single leaves close to it. Pure. */

import { hashUnit } from "galewood/random";
import {
  type Components,
  nearRank,
  type PartArrays,
  type ReadPart,
  rankedIndex,
  type SingleLeaves,
} from "galewood/trees";
import { bareShoots, type CardMesh } from "./bareShoots";
import { leafSprays, SPRAY_VERTICES, type SprayHabit } from "./leafSprays";
import { dot, type Point, plus, unit } from "./points";
import { placedSprays } from "./singleLeaves";
import { type AddedArrays, evenColour } from "./wood/addedWood";

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
  look: Pick<PartArrays, "kind" | "uvs" | "colours">,
  rankOf: RankOf,
  numberOf: (vertex: number, card: number) => number = (_, v) => part.pieces[4 * v],
): PartArrays {
  const vertices = card.length;
  const pieces = new Float32Array(4 * vertices);
  const anchors = new Float32Array(4 * vertices);
  const ranks = new Float32Array(vertices);
  const free = look.kind === "leaves" ? 1 : 0;
  for (let k = 0; k < vertices; k++) {
    const v = card[k];
    ranks[k] = rankOf(k, v);
    pieces.set([numberOf(k, v), part.pieces[4 * v + 1], free, ranks[k]], 4 * k);
    anchors.set([bases[3 * k], bases[3 * k + 1], bases[3 * k + 2], part.anchors[4 * v + 3]], 4 * k);
  }
  const ranked = rankedIndex(index, (v) => ranks[v]);
  return { ...look, vertices, normals, positions, anchors, pieces, hold: card, ...ranked };
}

const cardMesh = ({ part, geometry }: ReadPart): CardMesh => ({
  positions: part.positions,
  first: cardsOf(geometry.pieces),
});

type RankOf = (vertex: number, card: number) => number;

/** The part whose material wood in place of leaf cards has; -1: there are no drawn twigs, and no such wood. */
export const twigsOf = (read: readonly ReadPart[]): number =>
  read.findIndex(({ geometry }) => geometry.kind === "twigs");

/** A part of wood in the colour of the twigs for each part of leaves; none for trees without drawn twigs. */
function twiggy(
  read: readonly ReadPart[],
  meshOf: (leaves: ReadPart) => OfCards & { rankOf: RankOf },
): AddedArrays[] {
  const twigs = read[twigsOf(read)]?.part;
  if (!twigs) return [];
  return read.flatMap((leaves, of): AddedArrays[] => {
    if (leaves.part.kind !== "leaves") return [];
    const { rankOf, ...mesh } = meshOf(leaves);
    const colours = evenColour(twigs.colours, mesh.card.length);
    const look = { kind: "wood", uvs: null, colours } as const;
    return [{ part: partOfCards(leaves, mesh, look, rankOf), of }];
  });
}

/** Shoots in place of leaf cards. */
export const barePartsOf = (read: readonly ReadPart[]): AddedArrays[] =>
  twiggy(read, (leaves) => {
    const { ranks, ...shoots } = bareShoots(cardMesh(leaves));
    return { ...shoots, rankOf: (vertex) => ranks[vertex] };
  });

const nearRanksOf =
  ({ part }: ReadPart): RankOf =>
  (_, card) =>
    nearRank(part.pieces[4 * card + 3]);

/** The shoots that bear the sprays. */
export const sprayStemsOf = (read: readonly ReadPart[]): AddedArrays[] =>
  twiggy(read, (leaves) => {
    const { ranks: _, ...shoots } = bareShoots(cardMesh(leaves), 1);
    return { ...shoots, rankOf: nearRanksOf(leaves) };
  });

/** Sprays in place of leaf cards. */
export const spraysOf = (read: readonly ReadPart[], habit: SprayHabit): AddedArrays[] =>
  read.flatMap((leaves, of): AddedArrays[] => {
    if (leaves.part.kind !== "leaves") return [];
    const { uvs, ...mesh } = leafSprays(cardMesh(leaves), habit);
    const { colours, normals: crown } = leaves.part;
    const look = { kind: "leaves", uvs, colours: colours && ofCards(colours, mesh.card) } as const;
    const normals = crownNormals(mesh, crown);
    return [{ part: partOfCards(leaves, { ...mesh, normals }, look, nearRanksOf(leaves), sprayNumber), of }];
  });

const pointAt = (values: Float32Array, v: number): Point => [
  values[3 * v],
  values[3 * v + 1],
  values[3 * v + 2],
];

/** Where leaves stand one by one, with the vertex that holds each spray; null unless they are the cards of one part. */
export function singlesOf(
  read: readonly ReadPart[],
): Pick<SingleLeaves, "shapeOf" | "sprays" | "hold"> | null {
  const [leaves, another] = read.filter((one) => one.part.kind === "leaves");
  if (!leaves || another) return null;
  const { normals, colours, pieces, anchors } = leaves.part;
  const { card, ...placed } = placedSprays(cardMesh(leaves), {
    crown: (v) => pointAt(normals, v),
    colour: (v) => (colours ? pointAt(colours, v) : [1, 1, 1]),
    openness: (v) => pieces[4 * v + 1],
    limb: (v) => anchors[4 * v + 3],
  });
  const before = read.slice(0, read.indexOf(leaves)).reduce((sum, one) => sum + one.part.vertices, 0);
  return { ...placed, hold: card.map((v) => before + v) };
}

const sprayNumber = (vertex: number) => hashUnit(Math.floor(vertex / SPRAY_VERTICES), 3);

/** Each vertex has the value of its card. */
function ofCards(values: Float32Array, card: Uint32Array): Float32Array {
  const own = new Float32Array(3 * card.length);
  card.forEach((v, k) => {
    for (let c = 0; c < 3; c++) own[3 * k + c] = values[3 * v + c];
  });
  return own;
}

/** Weight of a spray's own direction beside that of the crown at its card. */
const OWN_NORMAL_WEIGHT = 0.5;

/** Normals between those of the sprays and that of the crown, towards whose side they face. */
function crownNormals({ normals, card }: OfCards, crown: Float32Array): Float32Array {
  const mixed = new Float32Array(normals.length);
  card.forEach((v, k) => {
    const round = pointAt(crown, v);
    const own = pointAt(normals, k);
    const weight = OWN_NORMAL_WEIGHT * (dot(own, round) < 0 ? -1 : 1);
    mixed.set(unit(plus(round, own, weight)), 3 * k);
  });
  return mixed;
}
