/**
 * Two-dimensional Fourier transform, bit-identical to precompute/galewood/motion/wind/models/fourier.py: the order of
 * operations is fixed, and the roots of unity are computed with square roots.
 */

/** cos and sin of 2πk/n for k in [0, n). */
export interface Roots {
  readonly cosine: Float64Array;
  readonly sine: Float64Array;
}

/** n must be a power of two, at least 4. */
export function rootsOfUnity(n: number): Roots {
  const cosine = new Float64Array(n).fill(1);
  const sine = new Float64Array(n);
  let c = -1;
  let s = 0;
  for (let bit = n / 2; bit >= 1; bit /= 2) {
    for (let k = 0; k < n; k += 2 * bit) {
      cosine[k + bit] = cosine[k] * c - sine[k] * s;
      sine[k + bit] = cosine[k] * s + sine[k] * c;
    }
    const half = Math.sqrt((1 + c) / 2);
    s = bit === n / 2 ? 1 : s / (2 * half);
    c = half;
  }
  return { cosine, sine };
}

/** The numbers below n with their bits in reverse order. */
function reversedIndices(n: number): Uint32Array {
  const reversed = new Uint32Array(n);
  for (let i = 1; i < n; i++) reversed[i] = (reversed[i >> 1] >> 1) | (i & 1 ? n >> 1 : 0);
  return reversed;
}

function swap(values: Float64Array, i: number, j: number): void {
  const kept = values[i];
  values[i] = values[j];
  values[j] = kept;
}

/** Transforms every row of the flat (rows, columns) arrays in place; sign −1 forward, +1 backward, unscaled. */
export function transformRows(
  re: Float64Array,
  im: Float64Array,
  columns: number,
  rows: number,
  { cosine, sine }: Roots,
  sign: number,
): void {
  const reversed = reversedIndices(columns);
  for (let row = 0; row < rows * columns; row += columns) {
    for (let i = 0; i < columns; i++) {
      const j = reversed[i];
      if (i < j) {
        swap(re, row + i, row + j);
        swap(im, row + i, row + j);
      }
    }
    for (let half = 1; half < columns; half *= 2) {
      const stride = columns / (2 * half);
      for (let k = 0; k < half; k++) {
        const wr = cosine[k * stride];
        const wi = sign * sine[k * stride];
        for (let a = row + k; a < row + columns; a += 2 * half) {
          const b = a + half;
          const tr = re[b] * wr - im[b] * wi;
          const ti = re[b] * wi + im[b] * wr;
          re[b] = re[a] - tr;
          im[b] = im[a] - ti;
          re[a] += tr;
          im[a] += ti;
        }
      }
    }
  }
}

/** Same for every column; the inner loop runs along rows, which are contiguous in memory. */
export function transformColumns(
  re: Float64Array,
  im: Float64Array,
  columns: number,
  rows: number,
  { cosine, sine }: Roots,
  sign: number,
): void {
  const reversed = reversedIndices(rows);
  for (let i = 0; i < rows; i++) {
    const j = reversed[i];
    if (i >= j) continue;
    for (let x = 0; x < columns; x++) {
      swap(re, i * columns + x, j * columns + x);
      swap(im, i * columns + x, j * columns + x);
    }
  }
  for (let half = 1; half < rows; half *= 2) {
    const stride = rows / (2 * half);
    for (let k = 0; k < half; k++) {
      const wr = cosine[k * stride];
      const wi = sign * sine[k * stride];
      for (let first = k; first < rows; first += 2 * half) {
        const end = (first + 1) * columns;
        for (let a = first * columns, b = a + half * columns; a < end; a++, b++) {
          const tr = re[b] * wr - im[b] * wi;
          const ti = re[b] * wi + im[b] * wr;
          re[b] = re[a] - tr;
          im[b] = im[a] - ti;
          re[a] += tr;
          im[a] += ti;
        }
      }
    }
  }
}
