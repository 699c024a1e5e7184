/**
 * The leaves of a built-in tree one by one, as they are drawn close to the eye: each leaf in the picture of a spray becomes a folded and
 * arched blade with the picture of a single leaf, where that spray shows it. A shape for each spray of the picture. Pure.
 */
import { hashUnit } from "galewood/random";
import type { SprayShape } from "galewood/trees";
import type { CardMesh } from "./bareShoots";
import { ARCH_SHARE, forEachSpray, OF_LEAVES } from "./leafSprays";
import { between, cross, type Point, plus, unit } from "./points";
import { type DrawnLeaf, type DrawnSprays, SHEET_ROWS, SPRAY_TILES } from "./sprayTiles";

/** Rows and columns of vertices of a blade. */
const ROW_COUNT = 3;
const COLUMN_COUNT = 3;
export const BLADE_VERTICES = ROW_COUNT * COLUMN_COUNT;
/** The halves of a blade rise from its midrib, its tip hangs, and it leaves the plane of its spray: angles, rad. */
const FOLD_RAD = 0.3;
const ARCH_RAD = 0.9;
const PITCH_RAD = 0.9;
/** Radius of a shoot at its foot, relative to its spray, and how much is left of it at its tip. */
const SHOOT_RADIUS_SHARE = 0.006;
const SHOOT_TIP_SHARE = 0.4;
const SHOOT_SIDES = 3;

/** Where in the picture a petiole is: all of a shoot has its colour. */
type Spot = readonly [u: number, v: number];

interface Builder {
  readonly positions: number[];
  readonly normals: number[];
  readonly uvs: number[];
  readonly leaves: number[];
  readonly index: number[];
}

/** The bent surface of a spray: a point of its tile, and the directions along it and out of it there. */
function onSpray(x: number, y: number): { at: Point; along: Point; out: Point } {
  const slope = 4 * ARCH_SHARE * (1 - 2 * y);
  const along = unit([0, 1, slope]);
  return { at: [x - 0.5, y, 4 * ARCH_SHARE * y * (1 - y)], along, out: [0, -along[2], along[1]] };
}

const ACROSS: Point = [1, 0, 0];

/** Joins rows of `columns` vertices, which begin with this one, to triangles. */
function addRows(index: number[], first: number, rows: number, columns: number, closed = false): void {
  for (let row = 0; row + 1 < rows; row++) {
    for (let column = 0; column + (closed ? 0 : 1) < columns; column++) {
      const a = first + row * columns + column;
      const b = first + row * columns + ((column + 1) % columns);
      index.push(a, b, b + columns, a, b + columns, a + columns);
    }
  }
}

/** The blade of a leaf; `column`: of the tile with its picture. */
function addLeaf(
  to: Builder,
  [x, y, angle_rad, side, squeeze]: DrawnLeaf,
  { half, petiole }: DrawnSprays,
  column: number,
  number: number,
): void {
  const random = (channel: number) => hashUnit(number, channel) - 0.5;
  const { at: foot, along, out } = onSpray(x, y);
  const flat = between(along, ACROSS, angle_rad);
  const direction = between(flat, out, PITCH_RAD * random(11));
  const beside = unit(cross(direction, out));
  const roll_rad = Math.acos(Math.min(1, squeeze)) * (random(12) < 0 ? -1 : 1);
  const right = between(beside, cross(beside, direction), roll_rad);
  const up = cross(right, direction);
  const fold_rad = FOLD_RAD * (1 + random(13));
  const arch_rad = ARCH_RAD * (0.5 + random(14));
  const first = to.positions.length / 3;
  let middle = foot;
  for (let row = 0; row < ROW_COUNT; row++) {
    const b = row / (ROW_COUNT - 1);
    // the petiole is straight, the blade bends more and more
    const bent_rad = arch_rad * Math.max(0, (b - petiole) / (1 - petiole));
    const forward = between(direction, up, -bent_rad);
    if (row > 0) middle = plus(middle, forward, side / (ROW_COUNT - 1));
    const face = cross(right, forward);
    for (let k = 0; k < COLUMN_COUNT; k++) {
      const a = k - 1;
      const wing = between(right, face, Math.abs(a) * a * fold_rad);
      to.positions.push(...plus(middle, wing, a * half * side));
      to.normals.push(...unit(cross(wing, forward)));
      to.uvs.push((column + 0.5 + a * half) / SPRAY_TILES.columns, (SHEET_ROWS - b) / SHEET_ROWS);
      to.leaves.push(...foot, Math.max(1e-3, hashUnit(number, 15)));
    }
  }
  addRows(to.index, first, ROW_COUNT, COLUMN_COUNT);
}

/** A three-sided shoot along these points of the tile, from the first to the last. */
function addShoot(to: Builder, points: DrawnSprays["tiles"][number]["shoot"], [u, v]: Spot): void {
  const first = to.positions.length / 3;
  points.forEach(([x, y], k) => {
    const { at, out } = onSpray(x, y);
    const share = k / (points.length - 1);
    const radius = SHOOT_RADIUS_SHARE * (1 + (SHOOT_TIP_SHARE - 1) * share);
    for (let side = 0; side < SHOOT_SIDES; side++) {
      const normal = between(out, ACROSS, (2 * Math.PI * side) / SHOOT_SIDES);
      to.positions.push(...plus(at, normal, radius));
      to.normals.push(...normal);
      to.uvs.push(u, v);
      to.leaves.push(0, 0, 0, 0);
    }
  });
  addRows(to.index, first, points.length, SHOOT_SIDES, true);
}

/** The shapes of the sprays of a picture, in the order of its tiles. */
export function sprayShapes(drawn: DrawnSprays): SprayShape[] {
  return drawn.tiles.map(({ shoot, leaves }, tile) => {
    const to: Builder = { positions: [], normals: [], uvs: [], leaves: [], index: [] };
    const column = tile % SPRAY_TILES.columns;
    leaves.forEach((leaf, k) => {
      addLeaf(to, leaf, drawn, column, 64 * tile + k);
    });
    addShoot(to, shoot, [
      (column + 0.5) / SPRAY_TILES.columns,
      (SHEET_ROWS - 0.5 * drawn.petiole) / SHEET_ROWS,
    ]);
    return {
      positions: Float32Array.from(to.positions),
      normals: Float32Array.from(to.normals),
      uvs: Float32Array.from(to.uvs),
      leaves: Float32Array.from(to.leaves),
      index: Uint16Array.from(to.index),
    };
  });
}

/** What the vertices of the leaf cards know: each [vertices, components]; colour and openness of a vertex as functions. */
export interface CardLook {
  readonly crown: (vertex: number) => Point;
  readonly colour: (vertex: number) => Point;
  readonly openness: (vertex: number) => number;
  readonly limb: (vertex: number) => number;
}

/** Where the sprays in place of the cards are: their shapes, the first vertex of their cards, and `SPRAY_FLOATS` of each. */
export function placedSprays(
  cards: CardMesh,
  look: CardLook,
): { shapeOf: Uint8Array; card: Uint32Array; sprays: Float32Array } {
  const shapes: number[] = [];
  const firsts: number[] = [];
  const floats: number[] = [];
  forEachSpray(cards, OF_LEAVES, ({ foot, axis, facing, length, tile, mirrored }, number, first) => {
    shapes.push(tile);
    firsts.push(first);
    floats.push(...foot, look.limb(first), ...plus([0, 0, 0], axis, length), hashUnit(number, 7));
    floats.push(...facing, mirrored ? -1 : 1, ...look.crown(first), look.openness(first));
    floats.push(...look.colour(first), 0);
  });
  return {
    shapeOf: Uint8Array.from(shapes),
    card: Uint32Array.from(firsts),
    sprays: Float32Array.from(floats),
  };
}
