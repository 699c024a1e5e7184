/** Procedural tileable pictures: noise for clouds and ground, fallen leaves, grass. Pure. */
import { hashUnit } from "galewood/random";

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

/** Adds a share of value noise, which has this many cells along each side, to a picture of side × side pixels. */
function addNoise(picture: Float64Array, side: number, cells: number, seed: number, share: number): void {
  const at = lattice(cells, seed);
  const left = Int32Array.from({ length: side }, (_, x) => Math.floor((x * cells) / side));
  const weight = Float64Array.from(left, (cell, x) => smooth((x * cells) / side - cell));
  const rows = new Float64Array(cells * side); // between the lattice points of each row
  for (let i = 0; i < rows.length; i++) {
    const x = i % side;
    const row = cells * Math.floor(i / side);
    const right = left[x] + 1 === cells ? 0 : left[x] + 1;
    rows[i] = at[row + left[x]] * (1 - weight[x]) + at[row + right] * weight[x];
  }
  for (let y = 0; y < side; y++) {
    const near = side * left[y];
    const far = side * ((left[y] + 1) % cells);
    const [low, high] = [share * (1 - weight[y]), share * weight[y]];
    for (let x = 0; x < side; x++) picture[y * side + x] += low * rows[near + x] + high * rows[far + x];
  }
}

/** Four octaves of value noise, tileable, stretched to the full range 0 to 1; row by row. */
function tileFractal(side: number, coarsest: number, seed: number): Float64Array {
  const sum = new Float64Array(side * side);
  for (let k = 0; k < 4; k++) addNoise(sum, side, coarsest * 2 ** k, seed + k, 2 ** -k);
  for (let at = 0; at < sum.length; at++) {
    sum[at] = Math.min(1, Math.max(0, (sum[at] / 1.875 - 0.5) * 1.5 + 0.5));
  }
  return sum;
}

/** Three independent fractal noises in red, green and blue; a coarser one in alpha. */
export function paintNoise(side: number): Picture {
  const pixels = new Uint8Array(side * side * 4);
  for (let c = 0; c < 4; c++) {
    const noise = tileFractal(side, c === 3 ? 4 : 8, 100 * c + 7);
    for (let at = 0; at < noise.length; at++) pixels[4 * at + c] = Math.round(255 * noise[at]);
  }
  return { side, pixels };
}

type Rgb = readonly [number, number, number];

/** sRGB bytes of leaves on the ground, from fresh to old. */
const FALLEN_LEAF_COLOURS: readonly Rgb[] = [
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
    /** Colour of the background for noise from 0 to 1. */
    base: (noise: number) => Rgb,
    noise: Float64Array,
  ) {
    this.pixels = new Uint8Array(side * side * 4);
    for (let y = 0; y < side; y++) for (let x = 0; x < side; x++) this.set(x, y, base(noise[y * side + x]));
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
  const soil = (noise: number): Rgb => {
    const light = 0.6 + 0.5 * noise;
    return [104 * light, 70 * light, 36 * light];
  };
  const canvas = new Canvas(side, soil, tileFractal(side, 16, 5));
  const leaves = Math.round((side * side) / 90);
  for (let i = 0; i < leaves; i++) {
    const at = (channel: number) => hashUnit(31, i, channel);
    const colour = FALLEN_LEAF_COLOURS[Math.floor(at(0) * FALLEN_LEAF_COLOURS.length)];
    const light = 0.62 + 0.5 * at(1);
    const shade: Rgb = [colour[0] * light, colour[1] * light, colour[2] * light];
    canvas.leaf(at(2) * side, at(3) * side, 4 + 5 * at(4), at(5) * 6.283, shade);
  }
  return canvas;
}

/** Autumn grass, seen obliquely from above. */
export function paintGrass(side: number): Picture {
  const turf = (noise: number): Rgb => {
    const light = 0.7 + 0.5 * noise;
    return [108 * light, 108 * light, 44 * light];
  };
  const canvas = new Canvas(side, turf, tileFractal(side, 8, 9));
  const blades = Math.round((side * side) / 22);
  for (let i = 0; i < blades; i++) {
    const at = (channel: number) => hashUnit(47, i, channel);
    const dry = 0.8 * at(0) ** 2.5;
    const light = 0.72 + 0.36 * at(1);
    const colour: Rgb = [(118 + 82 * dry) * light, (128 + 36 * dry) * light, (48 + 34 * dry) * light];
    canvas.blade(at(2) * side, at(3) * side, 7 + 14 * at(4), at(5) - 0.5, colour);
  }
  return canvas;
}
