import { type Random, seededRandom } from "../random";
import { octaves, type TilingNoise, tilingNoise } from "./noise";
import { blank, type Colour, type Picture } from "./picture";

/** Height (0 groove, 1 ridge) and colour of the bark at a position in the tile. */
interface BarkPoint {
  height: number;
  colour: Colour;
}

export type Bark = (u: number, v: number) => BarkPoint;

export interface BarkPictures {
  colour: Picture;
  normal: Picture;
}

/** Colour and normal map (OpenGL convention, as in glTF) of a tileable bark. */
export function barkPictures(bark: Bark, width: number, height: number, relief: number): BarkPictures {
  const colour = blank(width, height);
  const heights = new Float32Array(width * height);
  for (let i = 0; i < width * height; i++) {
    const point = bark(((i % width) + 0.5) / width, (Math.floor(i / width) + 0.5) / height);
    heights[i] = point.height;
    colour.data.set([...point.colour, 1], i * 4);
  }
  return { colour, normal: normalPicture(heights, width, height, relief) };
}

function normalPicture(heights: Float32Array, width: number, height: number, relief: number): Picture {
  const picture = blank(width, height);
  const at = (x: number, y: number): number =>
    heights[((y + height) % height) * width + ((x + width) % width)];
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const dx = (at(x - 1, y) - at(x + 1, y)) * relief;
      const dy = (at(x, y + 1) - at(x, y - 1)) * relief;
      const length = Math.hypot(dx, dy, 1);
      const rgb = [0.5 + (0.5 * dx) / length, 0.5 + (0.5 * dy) / length, 0.5 + 0.5 / length, 1];
      picture.data.set(rgb, (y * width + x) * 4);
    }
  }
  return picture;
}

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
