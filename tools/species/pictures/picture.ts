import { PNG } from "pngjs";

/** A picture of floats in [0, 1] (red, green, blue, coverage), row by row from the top. */
export interface Picture {
  width: number;
  height: number;
  data: Float32Array;
}

export type Colour = readonly [number, number, number];

export function blank(width: number, height: number): Picture {
  return { width, height, data: new Float32Array(width * height * 4) };
}

/** Halves a picture; colours are weighted by coverage, so that transparent pixels do not contribute. */
export function halve(source: Picture): Picture {
  const target = blank(source.width >> 1, source.height >> 1);
  for (let y = 0; y < target.height; y++) {
    for (let x = 0; x < target.width; x++) averageFour(source, target, x, y);
  }
  return target;
}

function averageFour(source: Picture, target: Picture, x: number, y: number): void {
  const to = (y * target.width + x) * 4;
  const first = (2 * y * source.width + 2 * x) * 4;
  const row = source.width * 4;
  let coverage = 0;
  for (const from of [first, first + 4, first + row, first + row + 4]) {
    const weight = source.data[from + 3];
    coverage += weight;
    for (let c = 0; c < 3; c++) target.data[to + c] += weight * source.data[from + c];
  }
  if (coverage > 0) for (let c = 0; c < 3; c++) target.data[to + c] /= coverage;
  target.data[to + 3] = coverage / 4;
}

/** Gives transparent pixels the colour of nearby ones, so that filtering shows no fringe. Width = 2^n. */
export function bleed(picture: Picture): Picture {
  if (picture.width < 2 || picture.height < 2) return picture;
  const coarse = bleed(halve(picture));
  const { width, height, data } = picture;
  const filled: Picture = { width, height, data: data.slice() };
  for (let i = 0; i < width * height; i++) {
    if (data[i * 4 + 3] > 0) continue;
    const x = Math.min((i % width) >> 1, coarse.width - 1);
    const y = Math.min(Math.floor(i / width) >> 1, coarse.height - 1);
    const from = (y * coarse.width + x) * 4;
    for (let c = 0; c < 3; c++) filled.data[i * 4 + c] = coarse.data[from + c];
  }
  return filled;
}

/** Encodes as PNG (straight alpha); without coverage if `opaque`. */
export function encodePng(picture: Picture, opaque: boolean): Uint8Array {
  const { width, height, data } = picture;
  const png = new PNG({ width, height });
  for (let i = 0; i < data.length; i++) png.data[i] = Math.round(255 * Math.min(1, Math.max(0, data[i])));
  return PNG.sync.write(png, { colorType: opaque ? 2 : 6, inputColorType: 6, deflateLevel: 9 });
}

/** The RGBA bytes of a PNG. */
export function decodePng(bytes: Uint8Array): { width: number; height: number; data: Uint8Array } {
  return PNG.sync.read(Buffer.from(bytes));
}
