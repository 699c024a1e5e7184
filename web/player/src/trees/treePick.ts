/** Finds the first tree hit by a ray: tests the bounds, then spheres around the displaced joints. Pure. */

import type { Ray } from "../core/math/groundRay";
import { poseNow } from "../core/motion/nodePose";
import type { DrawnMotion } from "../core/table/drawnTable";
import type { Bounds } from "./culling/culling";
import { INSTANCE_FLOATS, type InstanceData } from "./instanceData";
import { leanOf } from "./lean";

export interface PickGroup {
  readonly instances: InstanceData;
  readonly bounds: Bounds;
  /** null for static trees. */
  readonly motion: DrawnMotion | null;
  /** Extent of the mesh around each joint, m at scale 1. */
  readonly jointRadius_m: Float32Array;
  readonly poses: Float32Array | null;
  /** Factor of the displacements on screen. */
  readonly exaggeration: number;
}

export interface PickedTree {
  readonly group: number;
  readonly tree: number;
  readonly distance_m: number;
}

interface Candidate {
  readonly group: number;
  readonly tree: number;
  readonly enters_m: number;
}

/** Distance along a ray (unit direction) to a sphere; infinite if the ray misses it or has passed it. */
export function ballEntry(
  ox: number,
  oy: number,
  oz: number,
  dx: number,
  dy: number,
  dz: number,
  radius: number,
): number {
  const along = -(ox * dx + oy * dy + oz * dz);
  const square = ox * ox + oy * oy + oz * oz - along * along;
  if (square > radius * radius) return Number.POSITIVE_INFINITY;
  const half = Math.sqrt(radius * radius - square);
  if (along + half < 0) return Number.POSITIVE_INFINITY;
  return Math.max(0, along - half);
}

function candidates(groups: readonly PickGroup[], { from, to }: Ray): Candidate[] {
  const found: Candidate[] = [];
  for (const [group, { instances, bounds }] of groups.entries()) {
    const half_m = 0.5 * bounds.height_m;
    const ball_m = Math.hypot(half_m, bounds.radius_m + bounds.reach_m);
    for (let tree = 0; tree < instances.count; tree++) {
      const at = tree * INSTANCE_FLOATS;
      const scale = instances.data[at + 6];
      const [ox, oy, oz] = [
        from.x - instances.data[at],
        from.y - instances.data[at + 1] - (bounds.low_m ?? 0) * scale,
        from.z - instances.data[at + 2],
      ];
      const enters_m = ballEntry(ox, oy - half_m * scale, oz, to.x, to.y, to.z, ball_m * scale);
      if (Number.isFinite(enters_m)) found.push({ group, tree, enters_m });
    }
  }
  return found.sort((a, b) => a.enters_m - b.enters_m);
}

/** Instances that stand upright, each with its lean. */
export type UprightTrees = Pick<InstanceData, "data" | "leans">;

/** The lean of one of the trees, horizontal way (x, z) per metre of height. */
export function leanAt({ data, leans }: UprightTrees, tree: number): readonly [number, number] {
  const at = tree * INSTANCE_FLOATS;
  return leans ? leanOf(data[at], data[at + 2]) : [0, 0];
}

/** The ray in the tree's frame at scale 1: origin, unit direction, and the length that a metre has there. */
export function ownRay(of: UprightTrees, tree: number, { from, to }: Ray): Float64Array {
  const at = tree * INSTANCE_FLOATS;
  const { data } = of;
  const scale = data[at + 6];
  const [leanX, leanZ] = leanAt(of, tree);
  const [cos, sin] = [data[at + 4] / scale, data[at + 5] / scale];
  const y = from.y - data[at + 1];
  const [x, z] = [from.x - data[at] - leanX * y, from.z - data[at + 2] - leanZ * y];
  const [alongX, alongZ] = [to.x - leanX * to.y, to.z - leanZ * to.y];
  const length = Math.hypot(alongX, to.y, alongZ);
  return Float64Array.of(
    (cos * x - sin * z) / scale,
    y / scale,
    (sin * x + cos * z) / scale,
    (cos * alongX - sin * alongZ) / length,
    to.y / length,
    (sin * alongX + cos * alongZ) / length,
    length / scale,
  );
}

/** The same of a ray before a tree's matrix was applied. */
function rayBefore(inverse: Float32Array, tree: number, { from, to }: Ray): Float64Array {
  const m = inverse.subarray(12 * tree, 12 * tree + 12);
  const turned = (v: Ray["to"]) => [0, 1, 2].map((row) => m[row] * v.x + m[row + 3] * v.y + m[row + 6] * v.z);
  const [x, y, z] = turned(from);
  const [dx, dy, dz] = turned(to);
  const length = Math.hypot(dx, dy, dz);
  return Float64Array.of(x + m[9], y + m[10], z + m[11], dx / length, dy / length, dz / length, length);
}

/** Distance along the ray to a tree, m. */
function entry(group: PickGroup, tree: number, ray: Ray): number {
  const { instances, bounds, motion, jointRadius_m, poses, exaggeration } = group;
  const own = instances.oriented
    ? rayBefore(instances.oriented.inverse, tree, ray)
    : ownRay(instances, tree, ray);
  const [ox, oy, oz, dx, dy, dz, length] = own;
  if (!motion) return crownEntry(bounds, ox, oy, oz, dx, dy, dz) / length;
  let nearest = Number.POSITIVE_INFINITY;
  const { jointRest_m: rest_m } = motion;
  const { jointMoved: moved } = poseNow(motion, poses, tree * motion.stride, exaggeration);
  for (const [joint, radius_m] of jointRadius_m.entries()) {
    const at = 3 * joint;
    const [x, y, z] = [
      rest_m[at] + moved[at],
      rest_m[at + 1] + moved[at + 1],
      rest_m[at + 2] + moved[at + 2],
    ];
    const t = ballEntry(ox - x, oy - y, oz - z, dx, dy, dz, radius_m);
    if (t < nearest) nearest = t;
  }
  return nearest / length;
}

/** Distance to a tree without nodes, approximated by the ellipsoid inside its bounds. */
function crownEntry(bounds: Bounds, ox: number, oy: number, oz: number, dx: number, dy: number, dz: number) {
  const half_m = 0.5 * bounds.height_m;
  const flat = half_m / bounds.radius_m; // scales the ellipsoid to a sphere
  const [x, z] = [dx * flat, dz * flat];
  const length = Math.hypot(x, dy, z);
  const t = ballEntry(ox * flat, oy - half_m, oz * flat, x / length, dy / length, z / length, half_m);
  return t / length;
}

/** The first tree hit by the ray; null if there is none. */
export function pickTree(groups: readonly PickGroup[], ray: Ray): PickedTree | null {
  let best: PickedTree | null = null;
  for (const { group, tree, enters_m } of candidates(groups, ray)) {
    if (best && enters_m > best.distance_m) break;
    const distance_m = entry(groups[group], tree, ray);
    if (distance_m < (best?.distance_m ?? Number.POSITIVE_INFINITY)) best = { group, tree, distance_m };
  }
  return best;
}

/** Radius of the sphere around a joint, relative to its farthest vertex: 1 covers all vertices, less the dense part. */
const JOINT_SPHERE_FILL = 0.75;

/** Extent of the mesh around each joint, from the vertices that it holds (xyz packed, table order). */
export function jointRadii(positions: readonly ArrayLike<number>[], motion: DrawnMotion): Float32Array {
  const { vertexJoint, jointRest_m } = motion;
  const radius_m = new Float32Array(motion.jointShare.length);
  let vertex = 0;
  for (const part of positions) {
    for (let i = 0; i < part.length; i += 3, vertex++) {
      const joint = vertexJoint[vertex];
      const [x, y, z] = [0, 1, 2].map((axis) => part[i + axis] - jointRest_m[joint * 3 + axis]);
      radius_m[joint] = Math.max(radius_m[joint], JOINT_SPHERE_FILL * Math.hypot(x, y, z));
    }
  }
  return radius_m;
}
