/** Shape of the land: pure functions of position, shared by terrain, placement and camera. */
import { fractalNoise, valueNoise } from "galewood/random";
import { smoothstep } from "../sky/weather";

const RANDOM_SEED = 20_260;

/** Centre line of the glade that leads away from the initial camera: x (m) for a given z. */
export function gladeCentre_m(z: number): number {
  return -6 + 9 * Math.sin(z / 34) + 5 * Math.sin(z / 71 + 1.3) + smoothstep(-40, 60, z) * 6;
}

/** Half the width of the glade: as usual, how much it varies, and how much wider it is near the initial camera. */
const HALF_WIDTH_M = { usual: 7, varying: 3, opening: 9 } as const;
const MOST_HALF_WIDTH_M = HALF_WIDTH_M.usual + HALF_WIDTH_M.varying + HALF_WIDTH_M.opening;
/** Shares of half the width within which the glade is whole, and beyond which is forest. */
const GLADE_EDGES = [0.3, 1.7] as const;

/** 1 in the middle of the glade, 0 in the forest. */
export function glade(x: number, z: number): number {
  const aside_m = Math.abs(x - gladeCentre_m(z));
  if (aside_m >= GLADE_EDGES[1] * MOST_HALF_WIDTH_M) return 0;
  const { usual, varying, opening } = HALF_WIDTH_M;
  const halfWidth_m =
    usual + varying * valueNoise(z / 40, 3.7, RANDOM_SEED + 5) + opening * smoothstep(0, 45, z);
  return 1 - smoothstep(halfWidth_m * GLADE_EDGES[0], halfWidth_m * GLADE_EDGES[1], aside_m);
}

/** Rounded ridges between 0 and 1. */
function ridge(x: number, z: number, seed: number): number {
  const folded = 1 - Math.abs(fractalNoise(x, z, seed, 4)) * 2;
  return Math.max(0, folded) ** 1.6 * (0.7 + 0.3 * valueNoise(x * 0.6, z * 0.6, seed + 7));
}

/** Height of the ground (m) at a position. */
export function groundHeight_m(x: number, z: number): number {
  const rolling = 4.2 * fractalNoise(x / 95, z / 95, RANDOM_SEED, 3);
  const hollow = -1.5 * glade(x, z);
  const distance = Math.hypot(x, z);
  const far = smoothstep(300, 1500, distance);
  const hills = far > 0 ? far * (46 + 95 * ridge(x / 620, z / 620, RANDOM_SEED + 9)) : 0;
  return rolling * (1 + smoothstep(150, 600, distance)) + hollow + hills;
}

/** Slope of the ground along x and z, over this distance on both sides. */
export function slopeAt(x: number, z: number, over_m: number): readonly [number, number] {
  const rise = (dx: number, dz: number) =>
    (groundHeight_m(x + dx, z + dz) - groundHeight_m(x - dx, z - dz)) / (2 * over_m);
  return [rise(over_m, 0), rise(0, over_m)];
}
