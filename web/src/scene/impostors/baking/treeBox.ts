/** The box that an impostor's pictures show: a tree is squeezed into a unit sphere, so that slender ones use all pixels. Pure. */

export interface TreeBox {
  /** Height of the centre, m. */
  readonly middle_m: number;
  /** Metres per unit along x and z, and along y. */
  readonly across_m: number;
  readonly up_m: number;
  /** Radius and half height of the tree in units. */
  readonly reach: number;
  readonly height_m: number;
}

/** Share of the unit sphere that the tree fills. */
const FILLED_SHARE = 0.97;

/** The box around all vertices, xyz packed per part. */
export function treeBox(parts: readonly ArrayLike<number>[]): TreeBox {
  let [low_m, high_m, radius_m] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY, 0];
  for (const at of parts) {
    for (let i = 0; i < at.length; i += 3) {
      low_m = Math.min(low_m, at[i + 1]);
      high_m = Math.max(high_m, at[i + 1]);
      radius_m = Math.max(radius_m, Math.hypot(at[i], at[i + 2]));
    }
  }
  const middle_m = 0.5 * (low_m + high_m);
  const half_m = Math.max(1e-3, high_m - middle_m);
  const across_m = Math.max(1e-3, radius_m);
  let most = 0;
  for (const at of parts) {
    for (let i = 0; i < at.length; i += 3) {
      const y = (at[i + 1] - middle_m) / half_m;
      most = Math.max(most, (at[i] ** 2 + at[i + 2] ** 2) / across_m ** 2 + y * y);
    }
  }
  const reach = FILLED_SHARE / Math.sqrt(most);
  return { middle_m, across_m: across_m / reach, up_m: half_m / reach, reach, height_m: high_m };
}
