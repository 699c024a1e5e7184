import { type Random, seededRandom } from "../random";
import type { Bark } from "./bark-picture";
import { octaves, type TilingNoise, tilingNoise } from "./noise";
import type { Colour } from "./picture";

interface Lens {
  u: number;
  v: number;
  halfWidth: number;
  halfHeight: number;
}

/** Young poplar: pale and smooth with dark, lens-shaped horizontal pores and a few branch scars. */
export function poplarBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  const pores = lenses(seededRandom(seed), 90, [0.015, 0.06], [0.002, 0.005]);
  const scars = lenses(seededRandom(seed + 1), 4, [0.05, 0.09], [0.008, 0.016]);
  return (u, v) => {
    const cloud = octaves(noise, u, v, 4, 8, 5);
    const band = octaves(noise, u, v, 3, 40, 3);
    const grain = octaves(noise, u + 0.3, v, 48, 64, 2);
    const dark = Math.max(lensDepth(pores, u, v) * 0.8, lensDepth(scars, u, v));
    const tone = cloud * 0.75 + band * 0.45 + grain * 0.25 - 0.2;
    const pale = mix([0.6, 0.62, 0.52], [0.9, 0.89, 0.82], tone);
    return {
      height: 0.4 + 0.3 * cloud + 0.2 * grain - 0.3 * dark,
      colour: mix(pale, [0.22, 0.19, 0.16], dark * 0.9),
    };
  };
}

/** Norway maple: grey-brown with long, shallow, branching furrows. */
export function mapleBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  return (u, v) => {
    const ridge = furrows(noise, u, v, 10, 6, 0.9);
    const grain = octaves(noise, u, v, 40, 24, 3);
    const cloud = octaves(noise, u + 0.37, v, 4, 6, 4);
    const wood = mix(
      [0.2, 0.17, 0.15],
      [0.6, 0.56, 0.51],
      0.72 * ridge + 0.55 * (grain - 0.35) + 0.25 * (cloud - 0.4),
    );
    const lichen = smooth(0.58, 0.72, cloud) * ridge;
    return { height: ridge * 0.75 + 0.25 * grain, colour: mix(wood, [0.62, 0.63, 0.52], 0.35 * lichen) };
  };
}

/** Apricot: dark reddish brown with vertical cracks and pale horizontal pores. */
export function apricotBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  const pores = lenses(seededRandom(seed), 90, [0.012, 0.04], [0.0015, 0.0035]);
  return (u, v) => {
    const ridge = furrows(noise, u, v, 6, 7, 0.65);
    const grain = octaves(noise, u, v, 20, 36, 4);
    const sheen = octaves(noise, u + 0.13, v, 3, 30, 3);
    const pore = lensDepth(pores, u, v) * ridge;
    const tone = 0.55 * ridge + 0.6 * (grain - 0.3) + 0.3 * (sheen - 0.4);
    const wood = mix([0.2, 0.13, 0.11], [0.53, 0.36, 0.29], tone);
    return {
      height: ridge * 0.6 + 0.35 * grain + 0.1 * pore,
      colour: mix(wood, [0.6, 0.45, 0.36], pore * 0.5),
    };
  };
}

/** Silver birch: white with grey bands, dark horizontal pores and black, diamond-shaped fissures. */
export function birchBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  const pores = lenses(seededRandom(seed), 70, [0.03, 0.12], [0.0018, 0.0045]);
  const fissures = lenses(seededRandom(seed + 1), 6, [0.05, 0.12], [0.01, 0.025]);
  return (u, v) => {
    const cloud = octaves(noise, u, v, 4, 6, 5);
    const band = octaves(noise, u, v, 2, 44, 3);
    const grain = octaves(noise, u + 0.3, v, 40, 64, 2);
    const wave = 0.05 * (octaves(noise, u, v + 0.2, 12, 16, 3) - 0.5);
    const fissure = lensDepth(fissures, u + wave, v + wave) * smooth(0.25, 0.5, grain + 0.25);
    const pore = lensDepth(pores, u, v);
    const pale = mix([0.6, 0.57, 0.53], [0.95, 0.94, 0.91], 0.5 + 0.7 * (cloud - 0.35) + 0.5 * (band - 0.4));
    const dark = Math.max(0.75 * pore, fissure);
    return {
      height: 0.6 + 0.15 * cloud + 0.1 * grain - 0.15 * pore - 0.5 * fissure,
      colour: mix(pale, [0.09, 0.08, 0.075], 0.92 * dark),
    };
  };
}

/** Colours of a bark in its cracks and on its ridges. */
interface BarkTones {
  dark: Colour;
  light: Colour;
}

/** Deep vertical furrows between ridges, so many across and along the tile, with some lichen: oak, ash, willow. */
export function furrowedBark(
  seed: number,
  { dark, light }: BarkTones,
  across: number,
  along: number,
  depth: number,
): Bark {
  const noise = tilingNoise(seed);
  return (u, v) => {
    const ridge = furrows(noise, u, v, across, along, depth);
    const grain = octaves(noise, u, v, 32, 20, 4);
    const cloud = octaves(noise, u + 0.37, v, 4, 5, 4);
    const tone = 0.75 * ridge + 0.6 * (grain - 0.4) + 0.3 * (cloud - 0.4);
    const wood = mix(dark, light, tone);
    const lichen = smooth(0.55, 0.7, cloud) * smooth(0.5, 1, ridge);
    return { height: 0.85 * ridge + 0.2 * grain, colour: mix(wood, [0.5, 0.54, 0.42], 0.4 * lichen) };
  };
}

/** Beech: smooth and silver-grey with faint bands, pale lichen and a few dark scars. */
export function beechBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  const scars = lenses(seededRandom(seed), 6, [0.03, 0.08], [0.004, 0.01]);
  return (u, v) => {
    const cloud = octaves(noise, u, v, 3, 5, 5);
    const band = octaves(noise, u, v, 3, 26, 3);
    const grain = octaves(noise, u + 0.3, v, 60, 60, 2);
    const scar = lensDepth(scars, u, v);
    const tone = 0.5 + 0.9 * (cloud - 0.45) + 0.35 * (band - 0.45) + 0.2 * (grain - 0.5);
    const grey = mix([0.4, 0.41, 0.39], [0.72, 0.72, 0.68], tone);
    const lichen = smooth(0.55, 0.75, octaves(noise, u + 0.6, v + 0.2, 6, 9, 4));
    return {
      height: 0.5 + 0.15 * cloud + 0.1 * grain - 0.25 * scar,
      colour: mix(mix(grey, [0.78, 0.8, 0.7], 0.35 * lichen), [0.2, 0.19, 0.17], 0.7 * scar),
    };
  };
}

/** Small scales, so many across and along the tile, greyed in places: spruce, larch, sycamore. */
export function scalyBark(seed: number, { dark, light }: BarkTones, across: number, along: number): Bark {
  const noise = tilingNoise(seed);
  const scales = cells(seededRandom(seed), across, along);
  return (u, v) => {
    const bend = 0.09 * (octaves(noise, u, v, 8, 10, 3) - 0.5);
    const scale = plate(scales, u + bend, v + bend);
    const grain = octaves(noise, u, v, 40, 48, 3);
    const cloud = octaves(noise, u + 0.4, v, 4, 6, 4);
    const tone = 0.3 * scale + 0.9 * (grain - 0.35) + 0.35 * (cloud - 0.4) + 0.1;
    const wood = mix(dark, light, tone);
    return { height: 0.7 * scale + 0.25 * grain, colour: mix(wood, [0.5, 0.48, 0.44], 0.45 * cloud) };
  };
}

/** Scots pine: orange-brown with long grey plates between dark cracks. */
export function pineBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  const large = cells(seededRandom(seed), 5, 5);
  const small = cells(seededRandom(seed + 1), 12, 22);
  return (u, v) => {
    const bend = 0.06 * (octaves(noise, u, v, 8, 8, 3) - 0.5);
    const block = plate(large, u + bend, v + bend);
    const flake = plate(small, u + bend, v - bend);
    const grain = octaves(noise, u, v, 24, 48, 3);
    const cloud = octaves(noise, u + 0.4, v, 3, 4, 4);
    const tone = 0.6 * block + 0.12 * (flake - 0.5) + 0.5 * (grain - 0.4);
    const wood = mix(
      [0.16, 0.09, 0.06],
      mix([0.62, 0.38, 0.23], [0.52, 0.44, 0.37], 1.6 * cloud),
      tone + 0.2,
    );
    return { height: 0.7 * block + 0.1 * flake + 0.15 * grain, colour: wood };
  };
}

/** Cells of a tile, each with a point somewhere in it: relative coordinates within the cell. */
interface Cells {
  across: number;
  along: number;
  points: readonly (readonly [number, number])[];
}

function cells(random: Random, across: number, along: number): Cells {
  const points = Array.from(
    { length: across * along },
    () => [random.uniform(0.1, 0.9), random.uniform(0.1, 0.9)] as const,
  );
  return { across, along, points };
}

/** Plates of bark, the Voronoi cells of the points: 1 on a plate, 0 in a crack between two of them. */
function plate({ across, along, points }: Cells, u: number, v: number): number {
  const [x, y] = [u * across, v * along];
  const [column, row] = [Math.floor(x), Math.floor(y)];
  let [nearest, next] = [Infinity, Infinity];
  for (let r = row - 1; r <= row + 1; r++) {
    for (let c = column - 1; c <= column + 1; c++) {
      const [px, py] = points[wrap(r, along) * across + wrap(c, across)];
      const distance = Math.hypot(c + px - x, r + py - y);
      if (distance < nearest) [nearest, next] = [distance, nearest];
      else if (distance < next) next = distance;
    }
  }
  return smooth(0.02, 0.3, next - nearest);
}

const wrap = (i: number, count: number): number => ((i % count) + count) % count;

/**
 * Ridges between two families of meandering cracks that lean in opposite directions and enclose long lozenges. 1 on a
 * ridge, down to 1 - depth in a crack; the depth varies.
 */
function furrows(
  noise: TilingNoise,
  u: number,
  v: number,
  across: number,
  along: number,
  depth: number,
): number {
  const meander = (shift: number): number => 2.6 * (octaves(noise, u + shift, v - shift, 4, 5, 4) - 0.5);
  const crack = (phase: number, strength: number): number => {
    const distance = Math.abs(phase - Math.round(phase));
    return strength * (1 - smooth(0.02, 0.26, distance));
  };
  const strong = (shift: number): number => smooth(0.25, 0.6, octaves(noise, u - shift, v + shift, 5, 6, 2));
  const right = crack(across * u + along * v + meander(0.11), strong(0.31));
  const left = crack(across * u - along * v + meander(0.57), strong(0.73));
  return 1 - depth * Math.max(right, left);
}

function lenses(random: Random, count: number, width: readonly number[], height: readonly number[]): Lens[] {
  return Array.from({ length: count }, () => ({
    u: random.uniform(0, 1),
    v: random.uniform(0, 1),
    halfWidth: random.uniform(width[0], width[1]),
    halfHeight: random.uniform(height[0], height[1]),
  }));
}

/** Depth of a position in any of the lenses, from 0 (outside) to 1; the tile is periodic. */
function lensDepth(list: readonly Lens[], u: number, v: number): number {
  let depth = 0;
  for (const lens of list) {
    const x = around(u - lens.u) / lens.halfWidth;
    const y = around(v - lens.v) / lens.halfHeight;
    depth = Math.max(depth, 1 - (x * x + y * y));
  }
  return smooth(0, 0.6, depth);
}

function around(x: number): number {
  return x - Math.round(x);
}

function smooth(low: number, high: number, x: number): number {
  const t = Math.min(1, Math.max(0, (x - low) / (high - low)));
  return t * t * (3 - 2 * t);
}

function mix(a: Colour, b: Colour, t: number): Colour {
  const s = Math.min(1, Math.max(0, t));
  return [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s, a[2] + (b[2] - a[2]) * s];
}
