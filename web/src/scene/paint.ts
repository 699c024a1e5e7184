/** Pictures painted once at start: noise for clouds and ground, a floor of fallen leaves, grass. Pure, tileable. */
import { hashUnit } from "../math/random";

export interface Picture {
  readonly side: number;
  /** RGBA, one byte a channel. */
  readonly pixels: Uint8Array<ArrayBuffer>;
}

const wrap = (i: number, period: number) => ((i % period) + period) % period;
const smooth = (t: number) => t * t * (3 - 2 * t);

/** Value noise in [0, 1] that repeats after `period` cells. */
function tileNoise(x: number, y: number, period: number, seed: number): number {
  const ix = Math.floor(x);
  const iy = Math.floor(y);
  const u = smooth(x - ix);
  const v = smooth(y - iy);
  const at = (dx: number, dy: number) => hashUnit(seed, wrap(ix + dx, period), wrap(iy + dy, period));
  const low = at(0, 0) * (1 - u) + at(1, 0) * u;
  return low * (1 - v) + (at(0, 1) * (1 - u) + at(1, 1) * u) * v;
}

/** Four octaves of tileNoise, stretched to use the whole range. */
function tileFractal(x: number, y: number, cells: number, seed: number): number {
  let sum = 0;
  for (let k = 0; k < 4; k++)
    sum += 2 ** -k * tileNoise(x * cells * 2 ** k, y * cells * 2 ** k, cells * 2 ** k, seed + k);
  return Math.min(1, Math.max(0, (sum / 1.875 - 0.5) * 1.5 + 0.5));
}

/** Three independent fractal noises in red, green and blue; a coarser one in alpha. */
export function paintNoise(side: number): Picture {
  const pixels = new Uint8Array(side * side * 4);
  for (let y = 0; y < side; y++) {
    for (let x = 0; x < side; x++) {
      for (let c = 0; c < 4; c++) {
        const value = tileFractal(x / side, y / side, c === 3 ? 4 : 8, 100 * c + 7);
        pixels[(y * side + x) * 4 + c] = Math.round(255 * value);
      }
    }
  }
  return { side, pixels };
}

type Rgb = readonly [number, number, number];

/** sRGB bytes of leaves on the ground, freshly fallen to old. */
const FALLEN: readonly Rgb[] = [
  [171, 88, 32],
  [196, 133, 44],
  [152, 58, 30],
  [214, 160, 62],
  [128, 84, 44],
  [178, 112, 52],
  [142, 106, 54],
];

class Canvas {
  readonly pixels: Uint8Array<ArrayBuffer>;

  constructor(
    readonly side: number,
    base: (x: number, y: number) => Rgb,
  ) {
    this.pixels = new Uint8Array(side * side * 4);
    for (let y = 0; y < side; y++) for (let x = 0; x < side; x++) this.set(x, y, base(x / side, y / side));
  }

  set(x: number, y: number, [r, g, b]: Rgb): void {
    const at = (wrap(y, this.side) * this.side + wrap(x, this.side)) * 4;
    this.pixels.set([Math.min(255, r), Math.min(255, g), Math.min(255, b), 255], at);
  }

  /** A pointed ellipse with a lighter middle rib. */
  leaf(cx: number, cy: number, length: number, angle: number, colour: Rgb): void {
    const cos = Math.cos(angle);
    const sin = Math.sin(angle);
    for (let y = -length; y <= length; y++) {
      for (let x = -length; x <= length; x++) {
        const along = (x * cos + y * sin) / length;
        const across = (y * cos - x * sin) / (0.5 * length);
        if (Math.abs(across) > 1 - along * along) continue;
        const light = 0.84 + 0.16 * along + (Math.abs(across) < 0.14 ? 0.14 : 0) + 0.1 * across;
        this.set(Math.round(cx + x), Math.round(cy + y), [
          colour[0] * light,
          colour[1] * light,
          colour[2] * light,
        ]);
      }
    }
  }

  /** A blade of grass, darker at its foot. */
  blade(x: number, y: number, length: number, lean: number, colour: Rgb): void {
    for (let step = 0; step < length; step++) {
      const light = 0.55 + (0.6 * step) / length;
      const bent = x + (lean * step * step) / length;
      this.set(Math.round(bent), Math.round(y - step), [
        colour[0] * light,
        colour[1] * light,
        colour[2] * light,
      ]);
    }
  }
}

/** Fallen leaves over each other on dark earth. */
export function paintLitter(side: number): Picture {
  const canvas = new Canvas(side, (x, y) => {
    const light = 0.6 + 0.5 * tileFractal(x, y, 16, 5);
    return [104 * light, 70 * light, 36 * light];
  });
  const leaves = Math.round((side * side) / 90);
  for (let i = 0; i < leaves; i++) {
    const at = (channel: number) => hashUnit(31, i, channel);
    const colour = FALLEN[Math.floor(at(0) * FALLEN.length)];
    const light = 0.62 + 0.5 * at(1);
    const shade: Rgb = [colour[0] * light, colour[1] * light, colour[2] * light];
    canvas.leaf(at(2) * side, at(3) * side, 4 + 5 * at(4), at(5) * 6.283, shade);
  }
  return canvas;
}

/** Autumn grass, seen from above at a slant. */
export function paintGrass(side: number): Picture {
  const canvas = new Canvas(side, (x, y) => {
    const light = 0.7 + 0.5 * tileFractal(x, y, 8, 9);
    return [108 * light, 108 * light, 44 * light];
  });
  const blades = Math.round((side * side) / 22);
  for (let i = 0; i < blades; i++) {
    const at = (channel: number) => hashUnit(47, i, channel);
    const dry = at(0) ** 1.5;
    const light = 0.75 + 0.4 * at(1);
    const colour: Rgb = [(118 + 82 * dry) * light, (128 + 36 * dry) * light, (48 + 34 * dry) * light];
    canvas.blade(at(2) * side, at(3) * side, 7 + 14 * at(4), at(5) - 0.5, colour);
  }
  return canvas;
}
