/** Pictures of low plants on transparent ground: a leafy twig of a shrub, and the frond of a fern. Pure. */
import { hashUnit } from "galewood/random";

/** Side of one picture; both lie side by side. */
export const PLANT_SIDE = 256;

export interface PlantAtlas {
  readonly width: number;
  readonly height: number;
  /** Lightness, share of wood, random number of the leaf, opacity; rows from the bottom up. */
  readonly pixels: Uint8Array<ArrayBuffer>;
}

/** Strokes this close leave no gaps. */
const STROKE_PX = 0.6;

interface Leaf {
  /** Foot of the leaf and its direction, in units of the picture's side; 0 points up. */
  readonly x: number;
  readonly y: number;
  readonly angle: number;
  readonly length: number;
  /** Half width relative to the length. */
  readonly wide: number;
  /** Pairs of side ribs; 0 for a plain leaf. */
  readonly ribs: number;
}

class Sheet {
  constructor(
    private readonly atlas: PlantAtlas,
    private readonly left: number,
  ) {}

  private dot(x: number, y: number, light: number, wood: number, random: number): void {
    if (x < 1 || y < 0 || x >= PLANT_SIDE - 1 || y >= PLANT_SIDE - 1) return;
    const at = (y * this.atlas.width + this.left + x) * 4;
    this.atlas.pixels.set([255 * Math.min(1, Math.max(0, light)), 255 * wood, 255 * random, 255], at);
  }

  stem(fromX: number, fromY: number, toX: number, toY: number, thick: number, wood: number): void {
    const steps = Math.ceil(2 * PLANT_SIDE * Math.hypot(toX - fromX, toY - fromY));
    for (let k = 0; k <= steps; k++) {
      const t = k / steps;
      const [cx, cy] = [
        PLANT_SIDE * (fromX + t * (toX - fromX) + 0.5),
        PLANT_SIDE * (fromY + t * (toY - fromY)),
      ];
      const r = PLANT_SIDE * thick * (1 - 0.5 * t);
      for (let y = Math.round(cy - r); y <= cy + r; y++) {
        for (let x = Math.round(cx - r); x <= cx + r; x++)
          this.dot(x, y, 0.45 + 0.25 * ((x - cx) / (r + 1)), wood, 0.5);
      }
    }
  }

  /** A leaf with a midrib and side ribs; one half is lighter than the other, as if folded. */
  leaf({ x, y, angle, length, wide, ribs }: Leaf, random: number): void {
    const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
    const size = PLANT_SIDE * length;
    const [footX, footY] = [PLANT_SIDE * (x + 0.5), PLANT_SIDE * y];
    for (let a = 0; a <= size; a += STROKE_PX) {
      const along = a / size;
      // Widest in the lower half, pointed at the tip, with a finely toothed edge.
      const tooth = 1 + 0.05 * Math.sin(along * 60);
      const half = size * wide * tooth * Math.sin(Math.PI * along ** 0.72) ** 0.9;
      for (let c = -half; c <= half; c += STROKE_PX) {
        const across = c / size;
        const fold = across > 0 ? 0.08 : -0.06;
        const rib = Math.abs(across) < 0.018 ? 0.2 : 0;
        const slant = ribs * (along - 1.1 * Math.abs(across));
        const vein = ribs > 0 && Math.abs(slant - Math.round(slant)) < 0.09 ? 0.1 : 0;
        this.dot(
          Math.round(footX + a * sine + c * cosine),
          Math.round(footY + a * cosine - c * sine),
          0.5 + fold + rib + vein + 0.24 * (random - 0.5) - 0.12 * (1 - along),
          0,
          random,
        );
      }
    }
  }
}

/** Leaves on each fork of a twig. */
const LEAVES_PER_FORK = 8;

/** A forked twig with leaves of different sizes. */
function paintTwig(sheet: Sheet): void {
  const forks = [
    [0, 0, 0.02, 0.9, 0.013],
    [0, 0.22, -0.3, 0.62, 0.009],
    [0, 0.34, 0.32, 0.72, 0.009],
    [0.01, 0.55, -0.18, 0.86, 0.007],
  ] as const;
  for (const [x0, y0, x1, y1, thick] of forks) sheet.stem(x0, y0, x1, y1, thick, 1);
  let number = 0;
  for (const [x0, y0, x1, y1] of forks) {
    const heading = Math.atan2(x1 - x0, y1 - y0);
    for (let k = 0; k < LEAVES_PER_FORK; k++) {
      const at = (channel: number) => hashUnit(131, number, channel);
      const t = 0.2 + (0.8 * (k + 0.4 * at(0))) / (LEAVES_PER_FORK - 0.5);
      const side = k === LEAVES_PER_FORK - 1 ? 0.2 : (k & 1 ? 1 : -1) * (0.7 + 0.5 * at(1));
      sheet.leaf(
        {
          x: x0 + Math.min(1, t) * (x1 - x0),
          y: y0 + Math.min(1, t) * (y1 - y0),
          angle: heading + side,
          length: 0.1 + 0.06 * at(2),
          wide: 0.27 + 0.07 * at(3),
          ribs: 7,
        },
        at(4),
      );
      number++;
    }
  }
}

/** A frond: pairs of narrow leaflets that get shorter towards tip and foot. */
function paintFrond(sheet: Sheet): void {
  const pairs = 13;
  for (let k = 0; k < pairs; k++) {
    const t = (k + 1) / (pairs + 1);
    const at = (channel: number) => hashUnit(137, k, channel);
    const length = 0.5 * (1 - t) ** 0.75 * (t + 0.05) ** 0.22 * (0.92 + 0.16 * at(0));
    for (const side of [-1, 1]) {
      sheet.leaf(
        {
          x: 0,
          y: 0.06 + 0.92 * t,
          angle: side * (1.32 - 0.5 * t),
          length: Math.max(0.03, length),
          wide: 0.075,
          ribs: 0,
        },
        0.3 + 0.5 * at(side + 2),
      );
    }
  }
  sheet.stem(0, 0, 0, 0.98, 0.008, 0.3);
}

export function paintPlants(): PlantAtlas {
  const width = 2 * PLANT_SIDE;
  const atlas = { width, height: PLANT_SIDE, pixels: new Uint8Array(width * PLANT_SIDE * 4) };
  paintTwig(new Sheet(atlas, 0));
  paintFrond(new Sheet(atlas, PLANT_SIDE));
  return atlas;
}
