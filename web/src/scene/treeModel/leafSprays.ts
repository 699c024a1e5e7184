/**
 * The sprays of a built-in tree: near the eye, each leaf card, the picture of a whole shoot, gives way to six bent sprays along
 * that shoot, each with a few leaves of its own. They fill the volume around the card, so that hardly a view shows them all edge-on.
 * Made in the browser, because they follow from the cards. Pure.
 */
import { hashUnit } from "galewood/random";
import { type CardMesh, type Shoot, shootOf } from "./bareShoots";
import { between, cross, dot, minus, type Point, plus, pointAlong, unit } from "./points";
import { SHEET_ROWS, SPRAY_SHARE, SPRAY_TILES } from "./sprayTiles";

export interface SprayMesh {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly uvs: Float32Array;
  readonly index: Uint32Array;
  /** Of each vertex: the card's first vertex, whose node it shares. */
  readonly card: Uint32Array;
  /** Of each vertex: the foot of its spray, about which it turns. */
  readonly bases: Float32Array;
}

/** Sprays of a card: along the shoot, to both sides in turn, and the last one at its tip. */
const FEET_SHARES = [0.03, 0.16, 0.29, 0.41, 0.5, 0.42] as const;
export const SPRAYS_PER_CARD = FEET_SHARES.length;
/** How the sprays of a shoot lie. */
export interface SprayHabit {
  /** Angle to the shoot of those at its sides, rad. */
  readonly side_rad: number;
  /** How far the tip of a spray hangs, relative to its length. */
  readonly hang_share: number;
}
/** That of sprays of leaves, single leaves included. */
export const HANG_SHARE = 0.13;
export const OF_LEAVES: SprayHabit = { side_rad: 0.85, hang_share: HANG_SHARE };
/** Sprays of needles lie along the shoot. */
export const OF_NEEDLES: SprayHabit = { side_rad: 0.4, hang_share: 0.25 };
/** Angle to the shoot of the spray at its tip, rad. */
const TIP_RAD = 0.15;
/** How far a spray turns out of the plane of the card and about its own axis, rad. */
const OUT_RAD = 1;
const ROLL_RAD = 0.8;
/** A spray arches: its middle rises, relative to its length. */
export const ARCH_SHARE = 0.07;
/** Rows of vertices along a spray, two in each. */
const ROW_COUNT = 3;
export const SPRAY_VERTICES = 2 * ROW_COUNT;
const SPRAY_INDEX = 6 * (ROW_COUNT - 1);
/** Triangles between two rows. */
const SQUARE_CORNERS = [0, 1, 3, 0, 3, 2] as const;

export interface Spray {
  readonly foot: Point;
  readonly axis: Point;
  readonly facing: Point;
  readonly length: number;
  /** Its tile of the picture, and whether that is shown mirrored. */
  readonly tile: number;
  readonly mirrored: boolean;
}

/** The directions of a shoot, all perpendicular to each other. */
interface ShootFrame extends Pick<Shoot, "from" | "to" | "size"> {
  readonly along: Point;
  readonly right: Point;
  readonly out: Point;
}

function frameOf({ from, to, across, size }: Shoot): ShootFrame {
  const along = unit(minus(to, from));
  const right = unit(plus(across, along, -dot(across, along)));
  return { from, to, size, along, right, out: cross(right, along) };
}

/** A spray of a shoot at this angle to its side; `number`: of all sprays. */
function sprayOf(
  { from, to, size, along, right, out }: ShootFrame,
  side_rad: number,
  k: number,
  number: number,
): Spray {
  const random = (channel: number) => hashUnit(number, channel) - 0.5;
  const side = between(right, out, (k % 2 ? Math.PI : 0) + 2 * OUT_RAD * random(1));
  const last = k === SPRAYS_PER_CARD - 1;
  const axis = between(along, side, (last ? TIP_RAD : side_rad) * (1 + 0.5 * random(2)));
  const facing = unit(plus(out, axis, -dot(out, axis)));
  return {
    foot: pointAlong(from, to, FEET_SHARES[k]),
    axis,
    facing: between(facing, cross(axis, facing), 2 * ROLL_RAD * random(3)),
    length: SPRAY_SHARE * size * (1 + 0.3 * random(4)),
    tile: Math.floor(hashUnit(number, 5) * SPRAY_TILES.columns * SPRAY_TILES.rows),
    mirrored: hashUnit(number, 6) < 0.5,
  };
}

function put(to: Float32Array, vertex: number, [x, y, z]: Point): void {
  to[3 * vertex] = x;
  to[3 * vertex + 1] = y;
  to[3 * vertex + 2] = z;
}

function addSpray(mesh: SprayMesh, spray: Spray, hang_share: number, number: number, card: number): void {
  const { foot, axis, facing, length, tile, mirrored } = spray;
  const across = cross(axis, facing);
  const { columns } = SPRAY_TILES;
  const [column, row] = [tile % columns, Math.floor(tile / columns)];
  const base = number * SPRAY_VERTICES;
  for (let r = 0; r < ROW_COUNT; r++) {
    const v = r / (ROW_COUNT - 1);
    const arched = plus(plus(foot, axis, v * length), facing, 4 * ARCH_SHARE * v * (1 - v) * length);
    const middle: Point = [arched[0], arched[1] - hang_share * v * v * length, arched[2]];
    const normal = unit(plus(facing, axis, 4 * ARCH_SHARE * (2 * v - 1)));
    for (let u = 0; u < 2; u++) {
      const vertex = base + 2 * r + u;
      put(mesh.positions, vertex, plus(middle, across, (u - 0.5) * length));
      put(mesh.normals, vertex, normal);
      put(mesh.bases, vertex, foot);
      mesh.uvs[2 * vertex] = (column + (mirrored ? 1 - u : u)) / columns;
      mesh.uvs[2 * vertex + 1] = (row + 1 - v) / SHEET_ROWS;
      mesh.card[vertex] = card;
    }
  }
  for (let k = 0; k < SPRAY_INDEX; k++) {
    mesh.index[number * SPRAY_INDEX + k] = base + 2 * Math.floor(k / 6) + SQUARE_CORNERS[k % 6];
  }
}

/** Calls `take` with each spray in place of leaf cards, its number, and the first vertex of its card. */
export function forEachSpray(
  cards: CardMesh,
  { side_rad }: SprayHabit,
  take: (spray: Spray, number: number, first: number) => void,
): void {
  cards.first.forEach((first, card) => {
    const frame = frameOf(shootOf(cards.positions, first, card));
    for (let k = 0; k < SPRAYS_PER_CARD; k++) {
      const number = card * SPRAYS_PER_CARD + k;
      take(sprayOf(frame, side_rad, k, number), number, first);
    }
  });
}

/** The sprays in place of leaf cards. */
export function leafSprays(cards: CardMesh, habit = OF_LEAVES): SprayMesh {
  const sprays = cards.first.length * SPRAYS_PER_CARD;
  const vertices = sprays * SPRAY_VERTICES;
  const mesh: SprayMesh = {
    positions: new Float32Array(3 * vertices),
    normals: new Float32Array(3 * vertices),
    uvs: new Float32Array(2 * vertices),
    index: new Uint32Array(SPRAY_INDEX * sprays),
    card: new Uint32Array(vertices),
    bases: new Float32Array(3 * vertices),
  };
  forEachSpray(cards, habit, (spray, number, first) => {
    addSpray(mesh, spray, habit.hang_share, number, first);
  });
  return mesh;
}
