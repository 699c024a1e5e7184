import { octaves, type TilingNoise, tilingNoise } from "./noise";
import { blank, type Colour, type Picture } from "./picture";
import { type Random, seededRandom } from "./random";

/** Height (0 groove, 1 ridge) and colour of bark at a place of the tile. */
export interface BarkPoint {
  height: number;
  colour: Colour;
}

export type Bark = (u: number, v: number) => BarkPoint;

export interface BarkPictures {
  colour: Picture;
  normal: Picture;
}

/** Colour and normal picture (OpenGL convention, as glTF wants it) of a tiling bark. */
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

/** Pale, smooth, with dark lens-shaped pores across and a few old branch scars: young poplar. */
export function poplarBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  const pores = lenses(seededRandom(seed), 70, [0.02, 0.07], [0.004, 0.009]);
  const scars = lenses(seededRandom(seed + 1), 5, [0.07, 0.12], [0.018, 0.03]);
  return (u, v) => {
    const cloud = octaves(noise, u, v, 4, 6, 5);
    const band = octaves(noise, u, v, 2, 24, 3);
    const dark = Math.max(lensDepth(pores, u, v) * 0.8, lensDepth(scars, u, v));
    const pale = mix([0.66, 0.68, 0.58], [0.88, 0.87, 0.8], cloud * 0.7 + band * 0.4 - 0.05);
    return { height: 0.6 + 0.25 * cloud - 0.3 * dark, colour: mix(pale, [0.2, 0.18, 0.15], dark * 0.9) };
  };
}

/** Grey-brown with long shallow furrows that part and join: Norway maple. */
export function mapleBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  return (u, v) => {
    const height = furrows(noise, u, v, 9, 3);
    const grain = octaves(noise, u, v, 24, 12, 3);
    const lichen = smooth(0.62, 0.75, octaves(noise, u + 0.37, v, 5, 5, 4)) * height;
    const wood = mix([0.17, 0.14, 0.12], [0.52, 0.47, 0.42], 0.75 * height + 0.35 * (grain - 0.3));
    return { height: height * 0.85 + 0.15 * grain, colour: mix(wood, [0.6, 0.6, 0.5], 0.35 * lichen) };
  };
}

/** Dark reddish brown, cracked along, with pale pores across: apricot. */
export function apricotBark(seed: number): Bark {
  const noise = tilingNoise(seed);
  const pores = lenses(seededRandom(seed), 60, [0.02, 0.05], [0.003, 0.006]);
  return (u, v) => {
    const height = furrows(noise, u, v, 6, 4);
    const grain = octaves(noise, u, v, 16, 16, 3);
    const pore = lensDepth(pores, u, v);
    const wood = mix([0.13, 0.08, 0.07], [0.42, 0.27, 0.21], 0.7 * height + 0.4 * (grain - 0.25));
    return {
      height: height * 0.8 + 0.15 * grain + 0.1 * pore,
      colour: mix(wood, [0.5, 0.36, 0.28], pore * 0.55),
    };
  };
}

/** Ridges: distance from the zero line of a warped noise that is stretched along the trunk. */
function furrows(noise: TilingNoise, u: number, v: number, across: number, along: number): number {
  const warp = (octaves(noise, u, v + 0.5, 4, 4, 3) - 0.5) * 0.22;
  const fine = (octaves(noise, u + 0.21, v, across * 2, along * 3, 3) - 0.5) * 0.35;
  const line = Math.abs(noise(u + warp, v, across, along) - 0.5 + fine * 0.5) * 2;
  return smooth(0.02, 0.42, line);
}

function lenses(random: Random, count: number, width: readonly number[], height: readonly number[]): Lens[] {
  return Array.from({ length: count }, () => ({
    u: random.uniform(0, 1),
    v: random.uniform(0, 1),
    halfWidth: random.uniform(width[0], width[1]),
    halfHeight: random.uniform(height[0], height[1]),
  }));
}

/** How deep a place lies in any of the lenses, 0 outside to 1; the tile wraps around. */
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
