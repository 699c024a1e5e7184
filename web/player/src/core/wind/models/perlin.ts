/**
 * Gusts from improved Perlin noise (Perlin 2002): three octaves that travel with the wind and change slowly.
 */
import {
  PERLIN_CELLS_PER_SCALE,
  PERLIN_CHANGE,
  PERLIN_EDGES,
  PERLIN_GAIN,
  PERLIN_LATERAL_SHARE,
  PERLIN_NOISE_VARIANCE,
  PERLIN_OCTAVES,
  PERLIN_SLANT,
} from "../../constants";
import type { ResolvedWind } from "../document";
import { type Gusts, type Output, type Places, View } from "../frame";
import { hash32 } from "../hashing";

/** Shuffled lattice of one seed: hashes of the first two coordinates, and gradients by the hash of all three. */
export interface Lattice {
  readonly order: Int32Array;
  readonly slopeX: Float64Array;
  readonly slopeY: Float64Array;
  readonly slopeZ: Float64Array;
}

/** `order` holds the integers 0 … 255 in seeded order, twice. */
function latticeOf(seed: number): Lattice {
  const order = Int32Array.from({ length: 512 }, (_, i) => i);
  for (let i = 255; i > 0; i--) {
    const j = hash32(seed, i) % (i + 1);
    const kept = order[i];
    order[i] = order[j];
    order[j] = kept;
  }
  order.copyWithin(256, 0, 256);
  const slopes = (axis: number) => Float64Array.from(order, (h) => PERLIN_EDGES[h & 15][axis]);
  return { order, slopeX: slopes(0), slopeY: slopes(1), slopeZ: slopes(2) };
}

/** Improved noise with mean 0 and a period of 256 cells in each direction. */
function noise({ order: p, slopeX, slopeY, slopeZ }: Lattice, px: number, py: number, pz: number): number {
  const fx = Math.floor(px);
  const fy = Math.floor(py);
  const fz = Math.floor(pz);
  const x = px - fx;
  const y = py - fy;
  const z = pz - fz;
  const x1 = x - 1;
  const y1 = y - 1;
  const z1 = z - 1;
  const i = fx & 255;
  const j = fy & 255;
  const k = fz & 255;
  const a = p[i] + j;
  const b = p[i + 1] + j;
  const aa = p[a] + k;
  const ab = p[a + 1] + k;
  const ba = p[b] + k;
  const bb = p[b + 1] + k;
  const n000 = slopeX[aa] * x + slopeY[aa] * y + slopeZ[aa] * z;
  const n100 = slopeX[ba] * x1 + slopeY[ba] * y + slopeZ[ba] * z;
  const n010 = slopeX[ab] * x + slopeY[ab] * y1 + slopeZ[ab] * z;
  const n110 = slopeX[bb] * x1 + slopeY[bb] * y1 + slopeZ[bb] * z;
  const n001 = slopeX[aa + 1] * x + slopeY[aa + 1] * y + slopeZ[aa + 1] * z1;
  const n101 = slopeX[ba + 1] * x1 + slopeY[ba + 1] * y + slopeZ[ba + 1] * z1;
  const n011 = slopeX[ab + 1] * x + slopeY[ab + 1] * y1 + slopeZ[ab + 1] * z1;
  const n111 = slopeX[bb + 1] * x1 + slopeY[bb + 1] * y1 + slopeZ[bb + 1] * z1;
  const u = x * x * x * (x * (x * 6 - 15) + 10);
  const v = y * y * y * (y * (y * 6 - 15) + 10);
  const w = z * z * z * (z * (z * 6 - 15) + 10);
  const n00 = n000 + u * (n100 - n000);
  const n10 = n010 + u * (n110 - n010);
  const n01 = n001 + u * (n101 - n001);
  const n11 = n011 + u * (n111 - n011);
  const n0 = n00 + v * (n10 - n00);
  return n0 + w * (n01 + v * (n11 - n01) - n0);
}

function octaveTotal(): number {
  let total = 0;
  for (let octave = 0; octave < PERLIN_OCTAVES; octave++) total += PERLIN_GAIN ** (2 * octave);
  return total;
}

const ALONG_SCALE = 1 / Math.sqrt(PERLIN_NOISE_VARIANCE * octaveTotal());
const ACROSS_SCALE = 1 / Math.sqrt(PERLIN_NOISE_VARIANCE);

export class PerlinGusts implements Gusts {
  private readonly lattice: Lattice;
  private readonly view = new View(PERLIN_LATERAL_SHARE);

  constructor(seed: number) {
    this.lattice = latticeOf(seed);
  }

  velocity(wind: ResolvedWind, travel: number, x: Places, z: Places, outX: Output, outZ: Output): void {
    const { view, lattice } = this;
    view.set(wind, travel);
    const change = PERLIN_CHANGE * travel;
    for (let i = 0; i < outX.length; i++) {
      const along = view.cosPerM * x[i] + view.sinPerM * z[i] - travel;
      const across = view.cosPerM * z[i] - view.sinPerM * x[i];
      const px = along * PERLIN_CELLS_PER_SCALE;
      const py = (across + PERLIN_SLANT * along) * PERLIN_CELLS_PER_SCALE;
      let a = 0;
      let gain = 1;
      let scale = 1;
      for (let o = 0; o < PERLIN_OCTAVES; o++) {
        a += gain * noise(lattice, px * scale + 17.31 * o, py * scale + 9.67 * o, change + 31.5 * o);
        gain *= PERLIN_GAIN;
        scale *= 2;
      }
      const b = noise(lattice, px + 101.4, py + 57.8, change + 0.5);
      view.write(i, a * ALONG_SCALE, b * ACROSS_SCALE, outX, outZ);
    }
  }
}
