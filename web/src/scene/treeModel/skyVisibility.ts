/**
 * How much of the sky each place in a crown sees: an occlusion volume of the tree. The leaf area is collected in a grid,
 * and from the middle of each cell rays go through it to the whole sky. Along a ray, leaves that face all ways let
 * exp(−K L) of the light pass, where L is the leaf area per area in its way (Beer's law in canopies: Monsi and Saeki 1953). Pure.
 */
import type { Point } from "./points";

/** Triangles that keep light away. */
export interface Leaves {
  readonly positions: ArrayLike<number>;
  readonly index: ArrayLike<number>;
  /** Share of their area that is leaf; the rest are gaps of their picture. */
  readonly cover: number;
}

/** Cells along each side of the grid. */
const GRID_CELLS = 10;
/**
 * Extinction coefficient: 0.5 for black leaves that face all ways, times the root of the share of the light that a leaf keeps, since the
 * rest goes on (Goudriaan 1977); of visible light three quarters (assumed).
 */
const EXTINCTION_K = 0.5 * Math.sqrt(0.75);
/** Steps of a ray relative to the shortest side of a cell. */
const STEP_SHARE = 0.7;
/** Triangles of a mesh whose area is collected; of a larger one, each stands for several. */
const MOST_TRIANGLES = 50_000;
/** Rings of rays with the same share of the sky each, and rays in each ring. */
const RING_COUNT = 3;
const RAYS_PER_RING = 5;

/** Rays to the whole sky. */
const RAYS: readonly Point[] = Array.from({ length: RING_COUNT * RAYS_PER_RING }, (_, ray) => {
  const ring = Math.floor(ray / RAYS_PER_RING);
  const up = (ring + 0.5) / RING_COUNT;
  const level = Math.sqrt(1 - up * up);
  const azimuth = (2 * Math.PI * (ray + ring / RING_COUNT)) / RAYS_PER_RING;
  return [level * Math.cos(azimuth), up, level * Math.sin(azimuth)];
});

interface Grid {
  readonly low: Point;
  /** Sides of a cell, m. */
  readonly cell_m: Point;
  /** A number for each cell. */
  readonly values: Float32Array;
}

const at = (x: number, y: number, z: number) => (z * GRID_CELLS + y) * GRID_CELLS + x;
const within = (cell: number) => Math.min(GRID_CELLS - 1, Math.max(0, Math.floor(cell)));

function emptyGrid(leaves: readonly Leaves[]): Grid | null {
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (const { positions, index } of leaves) {
    for (let i = 0; i < 3 * index.length; i++) {
      const axis = i % 3;
      const value = positions[3 * index[(i - axis) / 3] + axis];
      low[axis] = Math.min(low[axis], value);
      high[axis] = Math.max(high[axis], value);
    }
  }
  const side = (axis: 0 | 1 | 2) => Math.max(1e-3, (high[axis] - low[axis]) / GRID_CELLS);
  if (!Number.isFinite(low[0])) return null;
  return { low, cell_m: [side(0), side(1), side(2)], values: new Float32Array(GRID_CELLS ** 3) };
}

/** Adds the area of a triangle at the middles of the four triangles into which its sides' middles divide it, m². */
function addTriangle(
  { low, cell_m, values }: Grid,
  corners: readonly [Point, Point, Point],
  cover: number,
): void {
  const [a, b, c] = corners;
  const [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
  const [vx, vy, vz] = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
  const area_m2 = 0.5 * Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
  for (const [p, q] of QUARTERS) {
    const cell = (axis: 0 | 1 | 2) =>
      within((a[axis] + p * (b[axis] - a[axis]) + q * (c[axis] - a[axis]) - low[axis]) / cell_m[axis]);
    values[at(cell(0), cell(1), cell(2))] += 0.25 * cover * area_m2;
  }
}

const QUARTERS = [
  [1 / 3, 1 / 3],
  [2 / 3, 1 / 6],
  [1 / 6, 2 / 3],
  [1 / 6, 1 / 6],
] as const;

/** The leaf area in each cell, m²; null: there are no leaves. */
function leafArea(leaves: readonly Leaves[]): Grid | null {
  const grid = emptyGrid(leaves);
  if (!grid) return null;
  for (const { positions, index, cover } of leaves) {
    const corner = (k: number): Point => {
      const v = 3 * index[k];
      return [positions[v], positions[v + 1], positions[v + 2]];
    };
    const each = Math.ceil(index.length / (3 * MOST_TRIANGLES));
    for (let k = 0; k < index.length; k += 3 * each)
      addTriangle(grid, [corner(k), corner(k + 1), corner(k + 2)], each * cover);
  }
  return grid;
}

/** Adds to each cell what comes from the sky along a ray to its middle. `density`: leaf area per volume, 1/m. */
function addRay(seen: Grid, density: Float32Array, ray: Point): void {
  const { cell_m, values } = seen;
  const step_m = STEP_SHARE * Math.min(...cell_m);
  const [dx, dy, dz] = [0, 1, 2].map((axis) => (ray[axis] * step_m) / cell_m[axis]);
  for (let cell = 0; cell < values.length; cell++) {
    let x = (cell % GRID_CELLS) + 0.5 * (1 + dx);
    let y = (Math.floor(cell / GRID_CELLS) % GRID_CELLS) + 0.5 * (1 + dy);
    let z = Math.floor(cell / GRID_CELLS ** 2) + 0.5 * (1 + dz);
    let sum = 0;
    while (x >= 0 && x < GRID_CELLS && y < GRID_CELLS && z >= 0 && z < GRID_CELLS) {
      sum += density[at(Math.floor(x), Math.floor(y), Math.floor(z))];
      x += dx;
      y += dy;
      z += dz;
    }
    values[cell] += Math.exp(-EXTINCTION_K * sum * step_m) / RAYS.length;
  }
}

/** The share of the sky seen from the middle of each cell. */
function visibility({ low, cell_m, values }: Grid): Grid {
  const volume_m3 = cell_m[0] * cell_m[1] * cell_m[2];
  const density = values.map((area_m2) => area_m2 / volume_m3);
  const seen: Grid = { low, cell_m, values: new Float32Array(GRID_CELLS ** 3) };
  for (const ray of RAYS) addRay(seen, density, ray);
  return seen;
}

/** Between the middles of cells; beyond them the nearest one's. */
function sampled({ low, cell_m, values }: Grid, positions: ArrayLike<number>): Float32Array {
  const out = new Float32Array(positions.length / 3);
  const floor = [0, 0, 0];
  const share = [0, 0, 0];
  for (let v = 0; v < out.length; v++) {
    for (let axis = 0; axis < 3; axis++) {
      const place = (positions[3 * v + axis] - low[axis]) / cell_m[axis] - 0.5;
      const inside = Math.min(GRID_CELLS - 1, Math.max(0, place));
      floor[axis] = Math.min(GRID_CELLS - 2, Math.floor(inside));
      share[axis] = inside - floor[axis];
    }
    for (let corner = 0; corner < 8; corner++) {
      const [i, j, k] = [corner & 1, (corner >> 1) & 1, corner >> 2];
      const weight =
        (i ? share[0] : 1 - share[0]) * (j ? share[1] : 1 - share[1]) * (k ? share[2] : 1 - share[2]);
      out[v] += weight * values[at(floor[0] + i, floor[1] + j, floor[2] + k)];
    }
  }
  return out;
}

/** The share of the sky (0..1) that places (xyz packed, m) in or at a tree with these leaves see; 1 without leaves. */
export function skyVisibility(leaves: readonly Leaves[]): (positions: ArrayLike<number>) => Float32Array {
  const area = leafArea(leaves);
  if (!area) return (positions) => new Float32Array(positions.length / 3).fill(1);
  const seen = visibility(area);
  return (positions) => sampled(seen, positions);
}
