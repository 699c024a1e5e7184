/** Intersection of a ray with the ground. Pure. */

export interface Ray {
  readonly from: { x: number; y: number; z: number };
  /** Unit vector. */
  readonly to: { x: number; y: number; z: number };
}

const FARTHEST_M = 600;

/** Marches along the ray until it is below the ground, then bisects; null if it never is. */
export function groundUnder(
  ray: Ray,
  height_m: (x: number, z: number) => number,
): { x: number; z: number } | null {
  const above = (s: number) =>
    ray.from.y + s * ray.to.y - height_m(ray.from.x + s * ray.to.x, ray.from.z + s * ray.to.z);
  let near = 0;
  for (let far = 1; far < FARTHEST_M; far += 0.5 + 0.02 * far) {
    if (above(far) > 0) {
      near = far;
      continue;
    }
    let [low, high] = [near, far];
    for (let k = 0; k < 20; k++) {
      const middle = 0.5 * (low + high);
      if (above(middle) > 0) low = middle;
      else high = middle;
    }
    return { x: ray.from.x + low * ray.to.x, z: ray.from.z + low * ray.to.z };
  }
  return null;
}
