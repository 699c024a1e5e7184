/**
 * Eddies: two-dimensional stable fluids (Stam 1999) on a periodic grid, in the frame that moves with the wind.
 *
 * Bit-identical to precompute/galewood/motion/wind/models/navier_stokes.py, which explains the method. A step is divided
 * into slices, so that its cost is spread over several frames.
 */

import {
  EDDY_BAND,
  EDDY_CELLS_PER_STEP,
  EDDY_FRICTION,
  EDDY_GRID,
  EDDY_KICK,
  EDDY_LARGE_SCALE_FRICTION,
  EDDY_SLOWEST_START,
} from "../../constants";
import { hash32, signedUniform } from "../hashing";
import { rootsOfUnity, transformColumns, transformRows } from "./fourier";

export const SLICE_COUNT = 6;
/** Steps before the last one whose velocity is kept. */
export const PAST_STEPS = 2;
const CELL_COUNT = EDDY_GRID * EDDY_GRID;
const GRID_MASK = EDDY_GRID - 1;
const HALF_GRID = EDDY_GRID / 2;
const ROOTS = rootsOfUnity(EDDY_GRID);

const signed = (n: number): number => (n < HALF_GRID ? n : n - EDDY_GRID);

/** One run of the solver from a seeded start. */
export class Eddies {
  steps = 0;
  /** The velocity that is being prepared, and those of the last steps, the newest first. */
  private readonly fields = Array.from({ length: 2 + PAST_STEPS }, () => ({
    u: new Float64Array(CELL_COUNT),
    v: new Float64Array(CELL_COUNT),
  }));
  private slice = 0;

  constructor(private readonly seed: number) {
    const [{ u, v }] = this.fields;
    start(u, v, seed);
    this.correct(0);
    transformColumns(u, v, EDDY_GRID, EDDY_GRID, ROOTS, 1);
    transformRows(u, v, EDDY_GRID, EDDY_GRID, ROOTS, 1);
    this.turn();
  }

  /** Velocity (x, y) in standard deviations, this many of up to PAST_STEPS steps before the last one. */
  past(steps: number): { readonly u: Float64Array; readonly v: Float64Array } {
    return this.fields[1 + steps];
  }

  /** Makes what was prepared the newest velocity. */
  private turn(): void {
    this.fields.unshift(...this.fields.splice(-1));
  }

  /** Prepares the next step up to the given slice; the velocity changes only in `finish`. */
  prepare(slices: number): void {
    for (; this.slice < Math.min(slices, SLICE_COUNT); this.slice++) this.work(this.slice);
  }

  /** Completes one step. */
  finish(): void {
    this.prepare(SLICE_COUNT);
    this.slice = 0;
    this.steps++;
    this.turn();
  }

  private work(slice: number): void {
    const [{ u, v }, now] = this.fields;
    if (slice === 0) advect(now.u, now.v, u, v);
    else if (slice === 1) transformRows(u, v, EDDY_GRID, EDDY_GRID, ROOTS, -1);
    else if (slice === 2) transformColumns(u, v, EDDY_GRID, EDDY_GRID, ROOTS, -1);
    else if (slice === 3) this.correct(EDDY_KICK);
    else if (slice === 4) transformColumns(u, v, EDDY_GRID, EDDY_GRID, ROOTS, 1);
    else transformRows(u, v, EDDY_GRID, EDDY_GRID, ROOTS, 1);
  }

  private correct(kick: number): void {
    const done = kick > 0 ? this.steps + 1 : 0;
    const [{ u, v }] = this.fields;
    project(u, v, kick, hash32(this.seed, 7919 + done));
  }
}

/** Semi-Lagrangian advection with bilinear interpolation, which never amplifies. */
function advect(u: Float64Array, v: Float64Array, outU: Float64Array, outV: Float64Array): void {
  for (let y = 0; y < EDDY_GRID; y++) {
    for (let x = 0; x < EDDY_GRID; x++) {
      const i = y * EDDY_GRID + x;
      const px = x - EDDY_CELLS_PER_STEP * u[i];
      const py = y - EDDY_CELLS_PER_STEP * v[i];
      const fx = Math.floor(px);
      const fy = Math.floor(py);
      const tx = px - fx;
      const ty = py - fy;
      const x0 = fx & GRID_MASK;
      const x1 = (fx + 1) & GRID_MASK;
      const y0 = (fy & GRID_MASK) * EDDY_GRID;
      const y1 = ((fy + 1) & GRID_MASK) * EDDY_GRID;
      const w00 = (1 - tx) * (1 - ty);
      const w10 = tx * (1 - ty);
      const w01 = (1 - tx) * ty;
      const w11 = tx * ty;
      outU[i] = w00 * u[y0 + x0] + w10 * u[y0 + x1] + w01 * u[y1 + x0] + w11 * u[y1 + x1];
      outV[i] = w00 * v[y0 + x0] + w10 * v[y0 + x1] + w01 * v[y1 + x0] + w11 * v[y1 + x1];
    }
  }
}

/** Random amplitudes that decrease with the wavenumber; `project` turns them into a velocity. */
function start(re: Float64Array, im: Float64Array, seed: number): void {
  for (let y = 0; y < EDDY_GRID; y++) {
    for (let x = 0; x < EDDY_GRID; x++) {
      const k2 = signed(x) * signed(x) + signed(y) * signed(y);
      if (k2 < EDDY_SLOWEST_START * EDDY_SLOWEST_START) continue;
      const i = y * EDDY_GRID + x;
      const amplitude = 1 / (k2 * Math.sqrt(k2));
      re[i] = amplitude * signedUniform(seed, 2 * i);
      im[i] = amplitude * signedUniform(seed, 2 * i + 1);
    }
  }
}

function clearShortest(re: Float64Array, im: Float64Array): void {
  re[0] = 0;
  im[0] = 0;
  for (let n = 0; n < EDDY_GRID; n++) {
    re[HALF_GRID * EDDY_GRID + n] = 0;
    im[HALF_GRID * EDDY_GRID + n] = 0;
    re[n * EDDY_GRID + HALF_GRID] = 0;
    im[n * EDDY_GRID + HALF_GRID] = 0;
  }
}

/** Projects the spectrum of u + iv to be divergence-free, applies friction and forcing, and scales to unit variance. */
function project(re: Float64Array, im: Float64Array, kick: number, seed: number): void {
  const { cosine, sine } = ROOTS;
  clearShortest(re, im);
  let energy = 0;
  let kicks = 0;
  for (let y = 0; y < HALF_GRID; y++) {
    for (let x = 0; x < EDDY_GRID; x++) {
      const kx = signed(x);
      if (x === HALF_GRID || (y === 0 && kx <= 0)) continue;
      const i = y * EDDY_GRID + x;
      const j = ((EDDY_GRID - y) & GRID_MASK) * EDDY_GRID + ((EDDY_GRID - x) & GRID_MASK);
      const sx = sine[x];
      const sy = sine[y];
      const s2 = sx * sx + sy * sy;
      const k2 = kx * kx + y * y;
      const rub = 1 / (1 + EDDY_FRICTION + EDDY_LARGE_SCALE_FRICTION / k2);
      // a divergence-free field is the curl of a stream function: (sy, −sx) times one number
      let pr = (sy * (0.5 * (re[i] + re[j])) - sx * (0.5 * (im[i] + im[j]))) / s2;
      let pi = (sy * (0.5 * (im[i] - im[j])) - sx * (0.5 * (re[j] - re[i]))) / s2;
      pr *= rub;
      pi *= rub;
      if (kick > 0 && k2 >= EDDY_BAND[0] * EDDY_BAND[0] && k2 < EDDY_BAND[1] * EDDY_BAND[1]) {
        const push = (kick * CELL_COUNT) / (8 * Math.sqrt(s2));
        pr += push * signedUniform(seed, 2 * kicks);
        pi += push * signedUniform(seed, 2 * kicks + 1);
        kicks++;
      }
      const ur = sy * pr;
      const ui = sy * pi;
      const vr = -sx * pr;
      const vi = -sx * pi;
      re[i] = ur - vi;
      im[i] = ui + vr;
      re[j] = ur + vi;
      im[j] = vr - ui;
      const smooth = ((2 + cosine[x]) * (2 + cosine[y])) / 9; // attenuation by cubic spline sampling
      energy += smooth * smooth * (ur * ur + ui * ui + vr * vr + vi * vi);
    }
  }
  const scale = 1 / Math.sqrt(energy); // Parseval: the mean of u² + v² becomes 2
  for (let i = 0; i < CELL_COUNT; i++) {
    re[i] *= scale;
    im[i] *= scale;
  }
}
