/** Samples a periodic texture of gusts with cubic B-splines: twice differentiable, so that forces are smooth. */
import type { Output, Places, View } from "../frame";

/** Spline coefficients of the fluctuations along and across the wind; both dimensions are powers of two. */
export interface Picture {
  readonly along: Float64Array;
  readonly across: Float64Array;
  readonly columns: number;
  readonly rows: number;
  /** Grid cells per length scale. */
  readonly cellsAlong: number;
  readonly cellsAcross: number;
  /** Sideways drift per unit length along the wind, so that the periodic texture does not repeat at the same tree. */
  readonly slant: number;
}

/** Velocity (m/s) at positions x, z. */
export function samplePicture(
  picture: Picture,
  view: View,
  x: Places,
  z: Places,
  outX: Output,
  outZ: Output,
): void {
  const { along: gustsAlong, across: gustsAcross, columns, rows, slant } = picture;
  const { cosPerM, sinPerM, travel } = view;
  for (let i = 0; i < outX.length; i++) {
    const along = cosPerM * x[i] + sinPerM * z[i] - travel;
    const across = cosPerM * z[i] - sinPerM * x[i];
    const px = along * picture.cellsAlong;
    const py = (across + slant * along) * picture.cellsAcross;
    const fx = Math.floor(px);
    const fy = Math.floor(py);
    const t = px - fx;
    const r = 1 - t;
    const w0 = (r * r * r) / 6;
    const w1 = (4 - 3 * (t * t) * (2 - t)) / 6;
    const w2 = (4 - 3 * (r * r) * (2 - r)) / 6;
    const w3 = (t * t * t) / 6;
    const s = py - fy;
    const q = 1 - s;
    const a0 = (fx - 1) & (columns - 1);
    const a1 = fx & (columns - 1);
    const a2 = (fx + 1) & (columns - 1);
    const a3 = (fx + 2) & (columns - 1);
    let a = 0;
    let b = 0;
    for (let k = 0; k < 4; k++) {
      const row = ((fy - 1 + k) & (rows - 1)) * columns;
      const v =
        k === 0
          ? (q * q * q) / 6
          : k === 1
            ? (4 - 3 * (s * s) * (2 - s)) / 6
            : k === 2
              ? (4 - 3 * (q * q) * (2 - q)) / 6
              : (s * s * s) / 6;
      a +=
        v *
        (w0 * gustsAlong[row + a0] +
          w1 * gustsAlong[row + a1] +
          w2 * gustsAlong[row + a2] +
          w3 * gustsAlong[row + a3]);
      b +=
        v *
        (w0 * gustsAcross[row + a0] +
          w1 * gustsAcross[row + a1] +
          w2 * gustsAcross[row + a2] +
          w3 * gustsAcross[row + a3]);
    }
    view.write(i, a, b, outX, outZ);
  }
}
