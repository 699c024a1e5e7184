/** Soft shadows of trees on the ground, as a map: where the shadow maps do not reach. Pure. */

/** Texels along a side, and the side in metres; centred at the origin. */
export const SHADE_SIDE = 512;
export const SHADE_M = 960;
/** A low sun casts shadows of at most this many heights. */
const MAX_SHADOW_HEIGHTS = 2.6;
/** Discs along the shadow of one crown: enough to touch each other. */
const DISCS = { least: 3, most: 8 } as const;
/** The crown's part of the height. */
const CROWN_HEIGHT_RANGE = { from: 0.35, to: 0.9 } as const;

/** Trees as x, z, height, radius of the crown in m, packed. */
export const SHADER_FLOATS = 4;

const texel = (at_m: number) => ((at_m + SHADE_M / 2) / SHADE_M) * SHADE_SIDE - 0.5;

/** Adds a soft disc: full within half its radius, nothing at its rim. Runs some 10,000 times, hence without roots. */
function addDisc(map: Uint8Array, x_m: number, z_m: number, radius_m: number, strength: number): void {
  const [cx, cz, r] = [texel(x_m), texel(z_m), (radius_m / SHADE_M) * SHADE_SIDE];
  const last = SHADE_SIDE - 1;
  for (let row = Math.max(0, Math.ceil(cz - r)); row <= Math.min(last, cz + r); row++) {
    for (let column = Math.max(0, Math.ceil(cx - r)); column <= Math.min(last, cx + r); column++) {
      const out = ((column - cx) * (column - cx) + (row - cz) * (row - cz)) / (r * r);
      if (out >= 1) continue;
      const share = out < 0.25 ? strength : (4 / 3) * strength * (1 - out);
      const at = row * SHADE_SIDE + column;
      map[at] += (255 - map[at]) * share;
    }
  }
}

/**
 * Shade of all trees: 0 in the light, 255 in full shade. `sun`: direction towards the sun. Crowns cast discs along the
 * shadow, from a third of the height to the top.
 */
export function shadeOf(
  trees: ArrayLike<number>,
  sun: { readonly x: number; readonly y: number; readonly z: number },
  map = new Uint8Array(SHADE_SIDE * SHADE_SIDE),
): Uint8Array {
  map.fill(0);
  const flat = Math.hypot(sun.x, sun.z) || 1;
  const perHeight = Math.min(MAX_SHADOW_HEIGHTS, flat / Math.max(0.02, sun.y)) / flat;
  for (let at = 0; at < trees.length; at += SHADER_FLOATS) {
    const [x, z, height_m, radius_m] = [trees[at], trees[at + 1], trees[at + 2], trees[at + 3]];
    const long_m = (CROWN_HEIGHT_RANGE.to - CROWN_HEIGHT_RANGE.from) * height_m * perHeight * flat;
    const discs = Math.min(DISCS.most, Math.max(DISCS.least, Math.ceil(1 + long_m / radius_m)));
    for (let disc = 0; disc < discs; disc++) {
      const way_m =
        height_m *
        (CROWN_HEIGHT_RANGE.from + ((CROWN_HEIGHT_RANGE.to - CROWN_HEIGHT_RANGE.from) * disc) / (discs - 1)) *
        perHeight;
      addDisc(map, x - sun.x * way_m, z - sun.z * way_m, 1.25 * radius_m, 0.48);
    }
  }
  return map;
}
