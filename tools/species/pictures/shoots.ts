import type { Random } from "../random";
import type { LeafLook, SideShoots } from "./leaf-look";
import type { LeafPoint } from "./outline";
import type { Colour } from "./picture";

/** A leaf on a card, in card coordinates; `squeeze` < 1 shows it turned away from the viewer. */
export interface Leaf {
  x: number;
  y: number;
  angle: number;
  length: number;
  squeeze: number;
  colour: Colour;
  /** Drawn with many pixels: its petiole as thin as it is, with the finest veins. */
  fine?: boolean;
}

export interface Shoot {
  points: LeafPoint[];
  weight: number;
}

/** Points of a shoot: leaves are placed at points, so that there must be as many. */
const LEAST_POINTS = 25;

/** Where side shoots end, relative to the length of the main shoot. */
const UPPERMOST_SIDE = 0.86;

/** A main shoot and alternating side shoots, for this number of leaves. */
export function growShoots(
  random: Random,
  sideCount: number,
  leafCount: number,
  { sideLength = 1, sideRise = 1, shortening = 0.48, lessRise = 0, lowest = 0.18 }: SideShoots = {},
): Shoot[] {
  const bend = random.around(0, 0.08);
  const points = Math.max(LEAST_POINTS, leafCount);
  const main = curve([0.5, 0], [0.5 + bend, 0.4], [0.5 - bend, 0.78], points);
  const shoots: Shoot[] = [{ points: main, weight: 1 }];
  for (let i = 0; i < sideCount; i++) {
    const start =
      main[Math.round((lowest + ((UPPERMOST_SIDE - lowest) / sideCount) * i) * (main.length - 1))];
    const side = i % 2 === 0 ? 1 : -1;
    const reach = sideLength * random.uniform(0.24, 0.34) * (1 - (shortening / sideCount) * i);
    const rise = sideRise * random.uniform(0.12, 0.24) * (1 - (lessRise / sideCount) * i);
    const middle: LeafPoint = [start[0] + side * reach * 0.5, start[1] + rise * 0.7];
    shoots.push({
      points: curve(start, middle, [start[0] + side * reach, start[1] + rise], points),
      weight: 0.6,
    });
  }
  return shoots;
}

/** The end of a shoot: its leaves are as large as the shoot is long. */
export function growTip(random: Random): Shoot[] {
  const bend = random.around(0, 0.07);
  return [{ points: curve([0.5, 0], [0.5 + bend, 0.28], [0.5 - bend, 0.56], LEAST_POINTS), weight: 1 }];
}

function curve(a: LeafPoint, b: LeafPoint, c: LeafPoint, points: number): LeafPoint[] {
  return Array.from({ length: points }, (_, i) => {
    const t = i / (points - 1);
    const blend = (k: 0 | 1): number => (1 - t) ** 2 * a[k] + 2 * t * (1 - t) * b[k] + t * t * c[k];
    return [blend(0), blend(1)] as const;
  });
}

/** Alternating leaves along the shoots, lower ones drawn first. */
export function placeLeaves(
  look: LeafLook,
  shoots: Shoot[],
  palette: readonly Colour[],
  random: Random,
): Leaf[] {
  const total = shoots.reduce((sum, shoot) => sum + shoot.weight, 0);
  const leaves = shoots.flatMap((shoot) => {
    const count = Math.round((look.leavesPerCard * shoot.weight) / total);
    return Array.from({ length: count }, (_, i) => leafOn(look, shoot, i, count, palette, random));
  });
  return leaves.sort((a, b) => a.y - b.y + 0.15 * (a.squeeze - b.squeeze));
}

function leafOn(
  look: LeafLook,
  shoot: Shoot,
  i: number,
  count: number,
  palette: readonly Colour[],
  random: Random,
): Leaf {
  const last = shoot.points.length - 1;
  const t = i === count - 1 ? 1 : (i + random.uniform(0.5, 1)) / count;
  const at = Math.min(last, Math.round((0.12 + 0.88 * t) * last));
  const [x, y] = shoot.points[at];
  const [px, py] = shoot.points[Math.max(0, at - 1)];
  const along = Math.atan2(x - px, y - py);
  const side = i === count - 1 ? 0 : i % 2 === 0 ? 1 : -1;
  const angle = along + (side * look.angle_deg * Math.PI) / 180 + random.around(0, 0.35);
  const base = palette[random.integer(palette.length)];
  const shade = random.uniform(0.86, 1.1);
  const colour: Colour = [base[0] * shade, base[1] * shade * random.around(1, 0.05), base[2] * shade];
  return {
    x,
    y,
    angle,
    length: look.length * random.uniform(0.78, 1.12),
    squeeze: random.uniform(0.66, 1),
    colour,
  };
}
