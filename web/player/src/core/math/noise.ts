import { hash32 } from "./random";

const quintic = (t: number) => t * t * t * (t * (t * 6 - 15) + 10);

function corner(ix: number, iz: number, seed: number): number {
  return hash32(hash32(ix ^ seed) ^ Math.imul(iz, 0x9e3779b1)) / 2147483648 - 1;
}

/** Smooth value noise in [-1, 1], twice differentiable, with a period far larger than any forest. */
export function valueNoise(x: number, z: number, seed: number): number {
  const ix = Math.floor(x);
  const iz = Math.floor(z);
  const u = quintic(x - ix);
  const v = quintic(z - iz);
  const near = corner(ix, iz, seed) * (1 - u) + corner(ix + 1, iz, seed) * u;
  const far = corner(ix, iz + 1, seed) * (1 - u) + corner(ix + 1, iz + 1, seed) * u;
  return near * (1 - v) + far * v;
}

/** Sum of `octaves` noises in [-1, 1], each with double the frequency and half the amplitude of the previous one. */
export function fractalNoise(x: number, z: number, seed: number, octaves: number): number {
  let sum = 0;
  let weight = 0;
  for (let k = 0; k < octaves; k++) {
    const amplitude = 2 ** -k;
    const frequency = 2 ** k;
    sum += amplitude * valueNoise(x * frequency, z * frequency, seed + k);
    weight += amplitude;
  }
  return sum / weight;
}
