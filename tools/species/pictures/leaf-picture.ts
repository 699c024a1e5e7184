import {
  type DrawnSprays,
  SHEET_ROWS,
  SHOOT_TILES_PER_SIDE,
  SPRAY_SHARE,
  SPRAY_TILES,
} from "../../../web/src/scene/treeModel/sprayTiles";
import { type Random, seededRandom } from "../random";
import type { LeafLook } from "./leaf-look";
import { octaves, tilingNoise } from "./noise";
import { insideLeaf, type LeafPoint } from "./outline";
import { blank, bleed, type Colour, halve, type Picture } from "./picture";
import { growShoots, growTip, type Leaf, placeLeaves, type Shoot } from "./shoots";

const OVERSAMPLING_FACTOR = 2;

/** Tiles of one picture, each with a different shoot. */
interface Sheet {
  columns: number;
  rows: number;
  tile_px: number;
  /** What is in the tile with this number. */
  grow(look: LeafLook, palette: readonly Colour[], random: Random, tile: number): LeafyShoots;
}

interface LeafyShoots {
  shoots: readonly Shoot[];
  leaves: readonly Leaf[];
}

function leafy(shoots: Shoot[], look: LeafLook, palette: readonly Colour[], random: Random): LeafyShoots {
  return { shoots, leaves: placeLeaves(look, shoots, palette, random) };
}

const CARDS: Sheet = {
  columns: SHOOT_TILES_PER_SIDE,
  rows: SHOOT_TILES_PER_SIDE,
  tile_px: 512,
  grow: (look, palette, random) =>
    leafy(growShoots(random, look.sideShoots, look.leavesPerCard), look, palette, random),
};
const FULLER_CARDS: Sheet = {
  ...CARDS,
  grow: (look, palette, random) => {
    const { sideShoots, leavesPerCard, fuller } = look;
    const shoots = growShoots(random, sideShoots, leavesPerCard, fuller);
    return fitted(look, leafy(shoots, look, palette, random));
  },
};
const SPRAY_COUNT = SPRAY_TILES.columns * SPRAY_TILES.rows;
const SPRAYS: Sheet = {
  columns: SPRAY_TILES.columns,
  rows: SHEET_ROWS,
  tile_px: 384,
  grow: (look, palette, random, tile) => {
    if (tile >= SPRAY_COUNT) return singleLeaf(look, palette);
    const shoots = look.sprayShoots
      ? growShoots(random, look.sideShoots, look.leavesPerCard, look.sprayShoots)
      : growTip(random);
    return fitted(look, leafy(shoots, look, palette, random));
  },
};
/** Sprays with more leaves are of needles, which are not drawn singly. */
const MOST_SINGLE = 30;
const SHOOT_POINTS = 4;
/** Half the width of a petiole, in leaf lengths: drawn thicker than it is where a leaf has few pixels. */
const PETIOLE_HALF = 0.022;
const FINE_PETIOLE_HALF = 0.012;

/** An upright leaf that fills its tile; nothing in place of a needle. */
function singleLeaf(look: LeafLook, [colour]: readonly Colour[]): LeafyShoots {
  if (look.leavesPerSpray > MOST_SINGLE) return { shoots: [], leaves: [] };
  const leaf = { x: 0.5, y: 0, angle: 0, length: 1, squeeze: 1, colour, fine: true };
  return fitted(look, { shoots: [], leaves: [leaf] });
}

/** Four different shoots in a 2 × 2 atlas of 1024 pixels. */
export function leafPicture(look: LeafLook, seed: number): Picture {
  return drawSheet(CARDS, look, seed);
}

/** The same for browsers, which draw fuller shoots of some species; null: they draw those of the mesh. */
export function fullerPicture(look: LeafLook, seed: number): Picture | null {
  return look.fuller ? drawSheet(FULLER_CARDS, { ...look, ...look.fuller }, seed) : null;
}

/** The look of the sprays: leaves have the size that they have on a card. */
const sprayLook = (look: LeafLook): LeafLook => ({
  ...look,
  length: look.length / SPRAY_SHARE,
  leavesPerCard: look.leavesPerSpray,
});

/** Eight different ends of shoots, and below them single leaves, in one atlas. */
export function sprayPicture(look: LeafLook, seed: number): Picture {
  return drawSheet(SPRAYS, sprayLook(look), seed + 1);
}

/** What `sprayPicture` shows; null for needles. `card_m`: side of the cards. */
export function drawnSprays(ofCards: LeafLook, seed: number, card_m: number): DrawnSprays | null {
  const look = sprayLook(ofCards);
  const [single] = singleLeaf(look, look.palettes[0]).leaves;
  if (!single) return null;
  const rounded = (value: number) => Math.round(1e3 * value) / 1e3;
  const tiles = Array.from({ length: SPRAY_COUNT }, (_, tile) => {
    const { shoots, leaves } = grownTile(SPRAYS, look, seed + 1, tile);
    const [{ points }] = shoots;
    const shoot = Array.from({ length: SHOOT_POINTS }, (_, k) => {
      const [x, y] = points[Math.round((k * (points.length - 1)) / (SHOOT_POINTS - 1))];
      return [rounded(x), rounded(y)] as const;
    });
    return {
      shoot,
      leaves: leaves.map(
        ({ x, y, angle, length, squeeze }) =>
          [
            rounded(x),
            rounded(y),
            rounded(angle),
            rounded(length / single.length),
            rounded(squeeze),
          ] as const,
      ),
    };
  });
  const half = single.length * Math.max(...look.outline.map(([x]) => x));
  return {
    half: rounded(half),
    petiole: rounded(single.length * look.petiole),
    petiole_m: rounded(card_m * ofCards.length * ofCards.petiole),
    tiles,
  };
}

function grownTile(sheet: Sheet, look: LeafLook, seed: number, tile: number): LeafyShoots {
  const palette = look.palettes[tile % look.palettes.length];
  return sheet.grow(look, palette, seededRandom(seed + 7919 * tile), tile);
}

/** Drawn at double size. */
function drawSheet(sheet: Sheet, look: LeafLook, seed: number): Picture {
  const size = sheet.tile_px * OVERSAMPLING_FACTOR;
  const large = blank(sheet.columns * size, sheet.rows * size);
  for (let tile = 0; tile < sheet.columns * sheet.rows; tile++) {
    const frame = new Frame(
      large,
      (tile % sheet.columns) * size,
      Math.floor(tile / sheet.columns) * size,
      size,
    );
    drawTile(frame, look, grownTile(sheet, look, seed, tile));
  }
  return bleed(halve(large));
}

function drawTile(frame: Frame, look: LeafLook, { shoots, leaves }: LeafyShoots): void {
  for (const shoot of shoots) drawStem(frame, shoot, look.stem);
  for (const leaf of leaves) {
    drawShadow(frame, look, leaf);
    drawPetiole(frame, look, leaf);
    drawLeaf(frame, look, leaf);
  }
}

/** One tile of the atlas; card coordinates run from (0, 0) at the bottom left to (1, 1) at the top right. */
class Frame {
  constructor(
    readonly picture: Picture,
    readonly left: number,
    readonly top: number,
    readonly size: number,
  ) {}

  /** Calls `paint` with the card coordinates and pixel offset of every pixel in the box. */
  each(low: LeafPoint, high: LeafPoint, paint: (x: number, y: number, at: number) => void): void {
    const margin = 6 * OVERSAMPLING_FACTOR;
    const clamp = (v: number): number =>
      Math.round(Math.min(this.size - margin, Math.max(margin, v * this.size)));
    for (let row = this.size - clamp(high[1]); row < this.size - clamp(low[1]); row++) {
      for (let column = clamp(low[0]); column < clamp(high[0]); column++) {
        const at = ((this.top + row) * this.picture.width + this.left + column) * 4;
        paint((column + 0.5) / this.size, 1 - (row + 0.5) / this.size, at);
      }
    }
  }

  put(at: number, colour: Colour): void {
    for (let c = 0; c < 3; c++) this.picture.data[at + c] = Math.min(1, Math.max(0, colour[c]));
    this.picture.data[at + 3] = 1;
  }
}

/** Largest extent of a tile's shoot: half its width and its height. */
const MOST_ACROSS = 0.485;
const MOST_HIGH = 0.985;

/** Shrinks a shoot about its foot until all its leaves are within the tile. */
function fitted(look: LeafLook, { shoots, leaves }: LeafyShoots): LeafyShoots {
  const edge = leaves.flatMap((leaf) =>
    look.outline.flatMap(([x, y]) => [fromBlade(look, leaf, x, y), fromBlade(look, leaf, -x, y)]),
  );
  const across = Math.max(...edge.map(([x]) => Math.abs(x - 0.5)));
  const scale = Math.min(1, MOST_ACROSS / across, MOST_HIGH / Math.max(...edge.map(([, y]) => y)));
  const moved = ([x, y]: LeafPoint): LeafPoint => [0.5 + scale * (x - 0.5), scale * y];
  return {
    shoots: shoots.map(({ points, weight }) => ({ points: points.map(moved), weight: scale * weight })),
    leaves: leaves.map((leaf) => {
      const [x, y] = moved([leaf.x, leaf.y]);
      return { ...leaf, x, y, length: scale * leaf.length };
    }),
  };
}

/** The card point of blade coordinates: the inverse of `toBlade`. */
function fromBlade(look: LeafLook, leaf: Leaf, bx: number, by: number): LeafPoint {
  const [across, along] = [leaf.length * leaf.squeeze * bx, leaf.length * (by + look.petiole)];
  const [sin, cos] = [Math.sin(leaf.angle), Math.cos(leaf.angle)];
  return [leaf.x + across * cos + along * sin, leaf.y - across * sin + along * cos];
}

/** Blade coordinates (leaf lengths) of card points; the blade starts where the petiole ends. */
function toBlade(look: LeafLook, { x, y, angle, length, squeeze }: Leaf) {
  const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
  return (px: number, py: number): LeafPoint => {
    const dx = (px - x) / length;
    const dy = (py - y) / length;
    return [(dx * cos - dy * sin) / squeeze, dx * sin + dy * cos - look.petiole];
  };
}

/** The shadow of a leaf: where it lies below the leaf, and how much smaller the leaf is. */
const SHADOW_OFFSET: LeafPoint = [0.006, 0.014];
const SHADOW_SHRINK = 0.94;
/** A shadow ends at this distance (leaf lengths) from a point on the blade, so that needles do not shade far. */
const SHADOW_REACH = 0.74;
const MIDDLE_OF_BLADE = 0.48;
/** By how much the box of a blade is larger than its outline, in leaf lengths: the outline is known by rows. */
const BOX_MARGIN = 0.004;

/** Bounding box of the blade, of `grown` times its size about its middle. */
function bladeBox(look: LeafLook, leaf: Leaf, grown = 1): [LeafPoint, LeafPoint] {
  const across = grown * Math.max(...look.outline.map(([x]) => x)) + BOX_MARGIN;
  const heights = look.outline.map(([, y]) => y);
  const [low, high] = [Math.min(...heights), Math.max(...heights)].map((y) => grown * (y - 0.5) + 0.5);
  const corners = [-across, across].flatMap((x) => [
    fromBlade(look, leaf, x, low - BOX_MARGIN),
    fromBlade(look, leaf, x, high + BOX_MARGIN),
  ]);
  const [xs, ys] = [corners.map(([x]) => x), corners.map(([, y]) => y)];
  return [
    [Math.min(...xs), Math.min(...ys)],
    [Math.max(...xs), Math.max(...ys)],
  ];
}

function around(x: number, y: number, r: number): [LeafPoint, LeafPoint] {
  return [
    [x - r, y - r],
    [x + r, y + r],
  ];
}

const larger = (a: LeafPoint, b: LeafPoint): LeafPoint => [Math.max(a[0], b[0]), Math.max(a[1], b[1])];
const smaller = (a: LeafPoint, b: LeafPoint): LeafPoint => [Math.min(a[0], b[0]), Math.min(a[1], b[1])];

function drawLeaf(frame: Frame, look: LeafLook, leaf: Leaf): void {
  const onBlade = toBlade(look, leaf);
  frame.each(...bladeBox(look, leaf), (x, y, at) => {
    const [bx, by] = onBlade(x, y);
    if (insideLeaf(look.outline, Math.abs(bx), by)) frame.put(at, bladeColour(look, leaf, bx, by));
  });
}

/** Darkens what lies under a leaf, so that the leaves of a shoot can be distinguished. */
function drawShadow(frame: Frame, look: LeafLook, leaf: Leaf): void {
  const data = frame.picture.data;
  const [right, up] = SHADOW_OFFSET;
  const onBlade = toBlade(look, leaf);
  const [low, high] = bladeBox(look, leaf, 1 / SHADOW_SHRINK).map(([x, y]): LeafPoint => [x - right, y - up]);
  const middle = fromBlade(look, leaf, 0, MIDDLE_OF_BLADE);
  const [lowest, highest] = around(...middle, SHADOW_REACH * leaf.length);
  frame.each(larger(low, lowest), smaller(high, highest), (x, y, at) => {
    if (data[at + 3] === 0) return;
    const [bx, by] = onBlade(x + right, y + up);
    if (!insideLeaf(look.outline, Math.abs(bx) * SHADOW_SHRINK, (by - 0.5) * SHADOW_SHRINK + 0.5)) return;
    for (let c = 0; c < 3; c++) data[at + c] *= 0.72;
  });
}

function drawPetiole(frame: Frame, look: LeafLook, leaf: Leaf): void {
  const onBlade = toBlade(look, leaf);
  frame.each(...around(leaf.x, leaf.y, leaf.length * (look.petiole + 0.1)), (x, y, at) => {
    const [bx, by] = onBlade(x, y);
    const onLine =
      Math.abs(bx * leaf.squeeze) < (leaf.fine ? FINE_PETIOLE_HALF : PETIOLE_HALF) &&
      by < 0.05 &&
      by > -look.petiole;
    if (onLine) frame.put(at, look.stem);
  });
}

function drawStem(frame: Frame, shoot: Shoot, stem: Colour): void {
  shoot.points.slice(1).forEach((end, i) => {
    const start = shoot.points[i];
    const half = 0.0075 * shoot.weight * (1 - 0.6 * (i / shoot.points.length));
    const low = smaller(start, end);
    const high = larger(start, end);
    frame.each([low[0] - half, low[1] - half], [high[0] + half, high[1] + half], (x, y, at) => {
      if (distance(x, y, start, end) < half) frame.put(at, stem);
    });
  });
}

/** Leaf colour: fold along the midrib, lighter veins, darker centre, worn edge. */
function bladeColour(look: LeafLook, leaf: Leaf, bx: number, by: number): Colour {
  const fold = bx * Math.cos(leaf.angle) > 0 ? 1.06 : 0.93;
  const bloom = 0.9 + 0.16 * Math.min(1, Math.max(0, by)) + 0.1 * Math.abs(bx);
  const [net, mottle] = leaf.fine ? fineBlade(bx, by) : [0, 1];
  const vein = Math.max(net, veinStrength(look, Math.abs(bx), by, leaf.fine ? FINE_VEIN_SHARE : 1));
  const base = fold * bloom * mottle * (1 - vein);
  const mix = (c: number): number => leaf.colour[c] * base + look.vein[c] * vein;
  return [mix(0), mix(1), mix(2)];
}

const bladeNoise = tilingNoise(23);
/** Meshes of the finest veins along a leaf, how wide these are in terms of the noise, and how strong. */
const NET_MESHES = 22;
const NET_WIDTH = 0.05;
const NET_STRENGTH = 0.13;
/** Width of the other veins relative to those of leaves with few pixels. */
const FINE_VEIN_SHARE = 0.6;
const MOTTLE_CELLS = 5;
const MOTTLE_SHARE = 0.2;

/** Strength of the finest veins, and lightness, at a point of a blade. */
function fineBlade(bx: number, by: number): [net: number, mottle: number] {
  const away = Math.abs(bladeNoise(bx, by, NET_MESHES, NET_MESHES) - 0.5);
  const mottle = 1 + MOTTLE_SHARE * (octaves(bladeNoise, bx, by, MOTTLE_CELLS, MOTTLE_CELLS, 3) - 0.5);
  return [NET_STRENGTH * Math.max(0, 1 - away / NET_WIDTH), mottle];
}

/** `width`: of the veins, relative to those of leaves with few pixels. */
function veinStrength(look: LeafLook, x: number, y: number, width: number): number {
  const midrib = x < width * 0.018 * (1.1 - y) ? 0.55 : 0;
  const side = look.veins.some(([a, b]) => distance(x, y, a, b) < width * 0.009) ? 0.3 : 0;
  return Math.max(midrib, side);
}

function distance(x: number, y: number, a: LeafPoint, b: LeafPoint): number {
  const dx = b[0] - a[0];
  const dy = b[1] - a[1];
  const t = Math.min(1, Math.max(0, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - a[0] - t * dx, y - a[1] - t * dy);
}
