/**
 * The shoots of a tree without its leaves: a leaf card is a picture of a whole shoot, and where it was, a thin twig with
 * side twigs is drawn in winter. Made in the browser, because they follow from the cards. Pure.
 */
import { hashUnit } from "galewood/random";
import { between, cross, minus, type Point, plus, pointAlong, unit } from "./points";

/** Cards of four vertices: the lower edge, then the upper one. */
export interface CardMesh {
  readonly positions: Float32Array;
  /** First vertex of each card. */
  readonly first: Uint32Array;
}

export interface ShootMesh {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly index: Uint32Array;
  /** Of each vertex: the card's first vertex, whose node it shares. */
  readonly card: Uint32Array;
  /** Of each vertex: the point to which its twig shrinks. */
  readonly bases: Float32Array;
  /** Of each vertex: rank of its twig in [0, 1). */
  readonly ranks: Float32Array;
}

const SIDE_COUNT = 3;
const TWIG_VERTICES = SIDE_COUNT + 1;
/** Twigs of a shoot: itself and its side twigs. */
const TWIGS_PER_SHOOT = 2;
/** Radius at the base over the length: 4 mm for a shoot of 45 cm. */
const RADIUS_LENGTH_RATIO = 0.009;
/** Share of the card's length that the shoot takes, and the length of the lowest side twig relative to it. */
const SHOOT_LENGTH_SHARE = 0.9;
const SIDE_LENGTH = 0.5;
const SIDE_ANGLE = 0.75;
/** Ranks of the shoots and of their side twigs: both disappear before their parent twigs. */
const RANKS = [
  [0.35, 0.8],
  [0.6, 1],
] as const;

/** The shoot that a card shows: from the middle of its lower edge towards that of its upper one, bent out of its plane. */
export interface Shoot {
  readonly from: Point;
  readonly to: Point;
  /** The sides of the card: upwards, and across. */
  readonly axis: Point;
  readonly across: Point;
  /** The normal of the card. */
  readonly out: Point;
  readonly size: number;
}

const bendOf = (card: number, channel: number) => 0.35 * (hashUnit(card, channel) - 0.5);

/** The shoot of the card with this number, whose vertices begin with `first`. */
export function shootOf(positions: Float32Array, first: number, card: number): Shoot {
  const corner = (k: number): Point => [
    positions[3 * (first + k)],
    positions[3 * (first + k) + 1],
    positions[3 * (first + k) + 2],
  ];
  const from = pointAlong(corner(0), corner(1), 0.5);
  const axis = minus(pointAlong(corner(3), corner(2), 0.5), from);
  const across = minus(corner(1), corner(0));
  const out = unit(cross(across, axis));
  const size = Math.hypot(...axis);
  const to = plus(plus(from, axis, SHOOT_LENGTH_SHARE), out, bendOf(card, 21) * size);
  return { from, to, axis, across, out, size };
}

/** Where the twigs of a card begin and end: the shoot along its middle, side twigs to the left or right. */
function twigsOf(shoot: Shoot, card: number, count: number): { from: Point; to: Point }[] {
  const { from: foot, to: tip, axis, across, out, size } = shoot;
  const twigs = [{ from: foot, to: tip }];
  for (let k = 1; k < count; k++) {
    const at = 0.2 + 0.4 * hashUnit(card, 30 + k);
    const length = SIDE_LENGTH * (1.1 - at) * (0.7 + 0.6 * hashUnit(card, 40 + k));
    const from = pointAlong(foot, tip, at);
    const side = hashUnit(card, 70 + k) < 0.5 ? SIDE_ANGLE : -SIDE_ANGLE;
    const to = plus(
      plus(plus(from, axis, length * 0.75), across, side * length),
      out,
      bendOf(card, 50 + k) * size,
    );
    twigs.push({ from, to });
  }
  return twigs;
}

/** The bare shoots in place of leaf cards; `count`: twigs of each, the shoot itself first. */
export function bareShoots({ positions, first }: CardMesh, count = TWIGS_PER_SHOOT): ShootMesh {
  const twigs = first.length * count;
  const vertices = twigs * TWIG_VERTICES;
  const mesh = {
    positions: new Float32Array(3 * vertices),
    normals: new Float32Array(3 * vertices),
    index: new Uint32Array(3 * SIDE_COUNT * twigs),
    card: new Uint32Array(vertices),
    bases: new Float32Array(3 * vertices),
    ranks: new Float32Array(vertices),
  };
  let twig = 0;
  first.forEach((vertex, card) => {
    twigsOf(shootOf(positions, vertex, card), card, count).forEach(({ from, to }, k) => {
      const [low, high] = RANKS[Math.min(k, 1)];
      addTwig(mesh, twig++, from, to, vertex, low + (high - low) * 0.999 * hashUnit(card, 60 + k));
    });
  });
  return mesh;
}

/** A three-sided spike. */
function addTwig(mesh: ShootMesh, twig: number, from: Point, to: Point, card: number, rank: number): void {
  const direction = minus(to, from);
  const length = Math.hypot(...direction);
  const helper: Point = Math.abs(direction[1]) > 0.9 * length ? [1, 0, 0] : [0, 1, 0];
  const u = unit(cross(direction, helper));
  const w = unit(cross(direction, u));
  const base = twig * TWIG_VERTICES;
  for (let k = 0; k <= SIDE_COUNT; k++) {
    const angle = (2 * Math.PI * k) / SIDE_COUNT;
    const normal = between(u, w, angle);
    const at = 3 * (base + k);
    mesh.positions.set(k === SIDE_COUNT ? to : plus(from, normal, RADIUS_LENGTH_RATIO * length), at);
    mesh.normals.set(k === SIDE_COUNT ? unit(direction) : normal, at);
    mesh.bases.set(from, at);
    mesh.card[base + k] = card;
    mesh.ranks[base + k] = rank;
    if (k < SIDE_COUNT)
      mesh.index.set(
        [base + k, base + ((k + 1) % SIDE_COUNT), base + SIDE_COUNT],
        3 * (SIDE_COUNT * twig + k),
      );
  }
}
