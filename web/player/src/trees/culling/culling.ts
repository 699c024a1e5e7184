/** Visibility of trees and of their shadows, with a margin for bending. Pure. */

/** Plane coefficients, positive inside: six of the camera's frustum. */
export type Planes = readonly { normal: Point; constant: number }[];

export interface Point {
  x: number;
  y: number;
  z: number;
}

/** Bounds of a species at scale 1: an upright cylinder around the tree at rest, and its largest displacement. */
export interface Bounds {
  readonly height_m: number;
  readonly radius_m: number;
  readonly reach_m: number;
  /** Height of the cylinder's lower end above the tree's origin; 0 if absent. */
  readonly low_m?: number;
}

/** Bounds of a species whose trees stand at any angle. */
export function orientedBounds({ height_m, radius_m, reach_m }: Bounds): Bounds {
  const ball_m = Math.hypot(height_m, radius_m) + reach_m;
  return { height_m: 2 * ball_m, radius_m: ball_m, reach_m: 0, low_m: -ball_m };
}

/** Whether a cylinder at a position intersects the space inside all planes; conservative. */
export function cylinderSeen(
  planes: Planes,
  x: number,
  y: number,
  z: number,
  height_m: number,
  radius_m: number,
): boolean {
  const half_m = 0.5 * height_m;
  for (const { normal, constant } of planes) {
    const middle = normal.x * x + normal.y * (y + half_m) + normal.z * z + constant;
    const flat = Math.sqrt(normal.x * normal.x + normal.z * normal.z);
    if (middle + Math.abs(normal.y) * half_m + flat * radius_m < 0) return false;
  }
  return true;
}

/**
 * Whether the shadow of such a cylinder may fall into the space inside all planes: tests its bounding sphere, swept
 * along the sun's rays by `slide_m`.
 */
export function shadowSeen(
  planes: Planes,
  sun: Point,
  x: number,
  y: number,
  z: number,
  radius_m: number,
  slide_m: number,
): boolean {
  for (const { normal, constant } of planes) {
    const at = normal.x * x + normal.y * y + normal.z * z + constant;
    const along = -slide_m * (normal.x * sun.x + normal.y * sun.y + normal.z * sun.z);
    if (Math.max(at, at + along) < -radius_m) return false;
  }
  return true;
}
