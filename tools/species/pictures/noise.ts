/** Value noise with a period of a whole number of cells, for tileable pictures. */
export type TilingNoise = (u: number, v: number, cellsU: number, cellsV: number) => number;

export function tilingNoise(seed: number): TilingNoise {
  const lattice = (x: number, y: number): number => {
    let h = Math.imul(x, 0x27d4eb2d) ^ Math.imul(y, 0x165667b1) ^ Math.imul(seed, 0x9e3779b1);
    h = Math.imul(h ^ (h >>> 15), 0x85ebca6b);
    h = Math.imul(h ^ (h >>> 13), 0xc2b2ae35);
    return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
  };
  return (u, v, cellsU, cellsV) => {
    const x = wrap(u) * cellsU;
    const y = wrap(v) * cellsV;
    const [i, j] = [Math.floor(x), Math.floor(y)];
    const [s, t] = [ease(x - i), ease(y - j)];
    const [i1, j1] = [(i + 1) % cellsU, (j + 1) % cellsV];
    const low = lattice(i, j) * (1 - s) + lattice(i1, j) * s;
    const high = lattice(i, j1) * (1 - s) + lattice(i1, j1) * s;
    return low * (1 - t) + high * t;
  };
}

/** Octaves of tiling noise, in [0, 1]. */
export function octaves(
  noise: TilingNoise,
  u: number,
  v: number,
  cellsU: number,
  cellsV: number,
  n: number,
): number {
  let sum = 0;
  let weight = 0;
  for (let k = 0; k < n; k++) {
    sum += noise(u, v, cellsU << k, cellsV << k) * 0.5 ** k;
    weight += 0.5 ** k;
  }
  return sum / weight;
}

function wrap(x: number): number {
  return x - Math.floor(x);
}

function ease(t: number): number {
  return t * t * (3 - 2 * t);
}
