/**
 * 1/f^β gusts: frozen turbulence with a given spectrum, carried over the forest by the mean wind.
 * precompute/galewood/motion/wind/models/spectral.py cites the sources.
 */
import {
  SPECTRAL_COLUMNS as COLUMNS,
  HASH_TURN_RAD,
  SPECTRAL_ROWS as ROWS,
  SPECTRAL_CELLS_ACROSS,
  SPECTRAL_CELLS_ALONG,
  SPECTRAL_DECAY,
  SPECTRAL_LATERAL_SHARE,
  SPECTRAL_SLANT,
  SPECTRAL_SLOWEST_COHERENCE,
  SPECTRAL_VON_KARMAN,
} from "../../constants";
import type { ResolvedWind } from "../document";
import { type Gusts, type Output, type Places, View } from "../frame";
import { hash32 } from "../hashing";
import { rootsOfUnity, transformColumns, transformRows } from "./fourier";
import { type Picture, samplePicture } from "./texture";

export class SpectralGusts implements Gusts {
  private readonly picture: Picture;
  private readonly view = new View(SPECTRAL_LATERAL_SHARE);

  constructor(seed: number, beta: number) {
    this.picture = spectralPicture(seed, beta);
  }

  velocity(wind: ResolvedWind, travel: number, x: Places, z: Places, outX: Output, outZ: Output): void {
    this.view.set(wind, travel);
    samplePicture(this.picture, this.view, x, z, outX, outZ);
  }
}

/** Frame of unit variance, to inspect the field itself in tests. */
function spectralPicture(seed: number, beta: number): Picture {
  const along = new Float64Array(ROWS * COLUMNS);
  const across = new Float64Array(ROWS * COLUMNS);
  for (let x = 0; x < COLUMNS; x++) writeColumn(along, across, seed, beta, x);
  toPicture(along, across);
  return {
    along,
    across,
    columns: COLUMNS,
    rows: ROWS,
    cellsAlong: SPECTRAL_CELLS_ALONG,
    cellsAcross: SPECTRAL_CELLS_ACROSS,
    slant: SPECTRAL_SLANT,
  };
}

const waveAcross = (y: number): number => (y <= ROWS / 2 ? y : y - ROWS) * (SPECTRAL_CELLS_ACROSS / ROWS);

/** Fixed amplitudes and seeded phases of one wavenumber along the wind; wavenumber 0 is omitted. */
function writeColumn(re: Float64Array, im: Float64Array, seed: number, beta: number, x: number): void {
  const n = Math.abs(x <= COLUMNS / 2 ? x : x - COLUMNS) * (SPECTRAL_CELLS_ALONG / COLUMNS);
  if (n === 0) return;
  const width =
    (SPECTRAL_DECAY / (2 * Math.PI)) *
    Math.sqrt(n * n + SPECTRAL_SLOWEST_COHERENCE * SPECTRAL_SLOWEST_COHERENCE);
  let total = 0;
  for (let y = 0; y < ROWS; y++) total += 1 / (width * width + waveAcross(y) * waveAcross(y));
  const power = (1 + SPECTRAL_VON_KARMAN * n * n) ** (-0.5 * beta);
  for (let y = 0; y < ROWS; y++) {
    const m = waveAcross(y);
    const amplitude = Math.sqrt(power / (total * (width * width + m * m)));
    const phase = hash32(seed, y * COLUMNS + x) * HASH_TURN_RAD;
    re[y * COLUMNS + x] = amplitude * Math.cos(phase);
    im[y * COLUMNS + x] = amplitude * Math.sin(phase);
  }
}

/** Transforms to space. Variances are normalized before the amplitudes are raised to compensate for spline smoothing. */
function toPicture(re: Float64Array, im: Float64Array): void {
  const alongRoots = rootsOfUnity(COLUMNS);
  const acrossRoots = rootsOfUnity(ROWS);
  let energy = 0;
  let cross = 0;
  for (let y = 0; y < ROWS; y++) {
    for (let x = 0; x < COLUMNS; x++) {
      const i = y * COLUMNS + x;
      const j = ((ROWS - y) & (ROWS - 1)) * COLUMNS + ((COLUMNS - x) & (COLUMNS - 1));
      energy += re[i] * re[i] + im[i] * im[i];
      cross += re[i] * re[j] - im[i] * im[j];
    }
  }
  for (let y = 0; y < ROWS; y++) {
    for (let x = 0; x < COLUMNS; x++) {
      const lift = 9 / ((2 + alongRoots.cosine[x]) * (2 + acrossRoots.cosine[y]));
      re[y * COLUMNS + x] *= lift;
      im[y * COLUMNS + x] *= lift;
    }
  }
  transformRows(re, im, COLUMNS, ROWS, alongRoots, 1);
  transformColumns(re, im, COLUMNS, ROWS, acrossRoots, 1);
  const scaleAlong = 1 / Math.sqrt(0.5 * (energy + cross));
  const scaleAcross = 1 / Math.sqrt(0.5 * (energy - cross));
  for (let i = 0; i < re.length; i++) {
    re[i] *= scaleAlong;
    im[i] *= scaleAcross;
  }
}
