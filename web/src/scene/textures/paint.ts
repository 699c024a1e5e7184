/** Procedural tileable pictures: noise for clouds and ground, fallen leaves, grass. Pure. */
import { hashUnit } from "../../core/math/random";

export interface Picture {
  readonly side: number;
  /** RGBA, one byte per channel. */
  readonly pixels: Uint8Array<ArrayBuffer>;
}

const wrap = (i: number, period: number) => ((i % period) + period) % period;
const smooth = (t: number) => t * t * (3 - 2 * t);

/** Random values at the lattice points, row by row. */
function lattice(cells: number, seed: number): Float64Array {
  return Float64Array.from({ length: cells * cells }, (_, i) =>
    hashUnit(seed, i % cells, Math.floor(i / cells)),
  );
}

/** Value noise in [0, 1] at x, y ≥ 0, periodic with the lattice. */
function tileNoise(x: number, y: number, cells: number, at: Float64Array): number {
  const ix = Math.floor(x) % cells;
  const iy = Math.floor(y) % cells;
  const u = smooth(x - Math.floor(x));
  const v = smooth(y - Math.floor(y));
  const right = (ix + 1) % cells;
  const low = cells * iy;
  const high = cells * ((iy + 1) % cells);
  const near = at[low + ix] * (1 - u) + at[low + right] * u;
  return near * (1 - v) + (at[high + ix] * (1 - u) + at[high + right] * u) * v;
}

/** Four octaves of tileNoise over the unit square, stretched to the full range. */
function tileFractal(coarsest: number, seed: number): (x: number, y: number) => number {
  const octaves = [0, 1, 2, 3].map((k) => ({
    cells: coarsest * 2 ** k,
    at: lattice(coarsest * 2 ** k, seed + k),
  }));
  return (x, y) => {
    let sum = 0;
    for (let k = 0; k < octaves.length; k++) {
      const { cells, at } = octaves[k];
      sum += 2 ** -k * tileNoise(x * cells, y * cells, cells, at);
    }
    return Math.min(1, Math.max(0, (sum / 1.875 - 0.5) * 1.5 + 0.5));
  };
}

/** Three independent fractal noises in red, green and blue; a coarser one in alpha. */
export function paintNoise(side: number): Picture {
  const pixels = new Uint8Array(side * side * 4);
  for (let c = 0; c < 4; c++) {
    const noise = tileFractal(c === 3 ? 4 : 8, 100 * c + 7);
    for (let y = 0; y < side; y++)
      for (let x = 0; x < side; x++)
        pixels[(y * side + x) * 4 + c] = Math.round(255 * noise(x / side, y / side));
  }
  return { side, pixels };
}

type Rgb = readonly [number, number, number];

/** sRGB bytes of leaves on the ground, from fresh to old. */
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

  set(x: number, y: number, colour: Rgb, light = 1): void {
    const at = (wrap(y, this.side) * this.side + wrap(x, this.side)) * 4;
    for (let c = 0; c < 3; c++) this.pixels[at + c] = Math.min(255, colour[c] * light);
    this.pixels[at + 3] = 255;
  }

  /** A pointed ellipse with a lighter midrib. */
  leaf(cx: number, cy: number, length: number, angle: number, colour: Rgb): void {
    const cos = Math.cos(angle);
    const sin = Math.sin(angle);
    for (let y = -length; y <= length; y++) {
      for (let x = -length; x <= length; x++) {
        const along = (x * cos + y * sin) / length;
        const across = (y * cos - x * sin) / (0.5 * length);
        if (Math.abs(across) > 1 - along * along) continue;
        const light = 0.84 + 0.16 * along + (Math.abs(across) < 0.14 ? 0.14 : 0) + 0.1 * across;
        this.set(Math.round(cx + x), Math.round(cy + y), colour, light);
      }
    }
  }

  /** A blade of grass, darker at its base. */
  blade(x: number, y: number, length: number, lean: number, colour: Rgb): void {
    for (let step = 0; step < length; step++) {
      const light = 0.55 + (0.6 * step) / length;
      const bent = x + (lean * step * step) / length;
      this.set(Math.round(bent), Math.round(y - step), colour, light);
    }
  }
}

/** Overlapping fallen leaves on dark soil. */
export function paintLitter(side: number): Picture {
  const noise = tileFractal(16, 5);
  const canvas = new Canvas(side, (x, y) => {
    const light = 0.6 + 0.5 * noise(x, y);
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

/** Autumn grass, seen obliquely from above. */
export function paintGrass(side: number): Picture {
  const noise = tileFractal(8, 9);
  const canvas = new Canvas(side, (x, y) => {
    const light = 0.7 + 0.5 * noise(x, y);
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
