/** Finds the first tree hit by a ray: tests the bounds, then the displaced nodes. Pure. */

import type { Ray } from "../../core/math/groundRay";
import type { TableMotion } from "../../worker/protocol";
import type { Bounds } from "./culling";
import { INSTANCE_FLOATS, type InstanceData } from "./instanceData";

export interface PickGroup {
  readonly instances: InstanceData;
  readonly bounds: Bounds;
  /** null for static trees. */
  readonly motion: TableMotion | null;
  /** Extent of the mesh around each node, m at scale 1. */
  readonly nodeRadius_m: Float32Array;
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
        from.y - instances.data[at + 1],
        from.z - instances.data[at + 2],
      ];
      const enters_m = ballEntry(ox, oy - half_m * scale, oz, to.x, to.y, to.z, ball_m * scale);
      if (Number.isFinite(enters_m)) found.push({ group, tree, enters_m });
    }
  }
  return found.sort((a, b) => a.enters_m - b.enters_m);
}

/** The ray in the tree's frame at scale 1: origin (xyz) and direction (xyz); distances are divided by the scale. */
export function ownRay(data: Float32Array, tree: number, { from, to }: Ray): Float64Array {
  const at = tree * INSTANCE_FLOATS;
  const scale = data[at + 6];
  const [cos, sin] = [data[at + 4] / scale, data[at + 5] / scale];
  const [x, y, z] = [from.x - data[at], from.y - data[at + 1], from.z - data[at + 2]];
  return Float64Array.of(
    (cos * x - sin * z) / scale,
    y / scale,
    (sin * x + cos * z) / scale,
    cos * to.x - sin * to.z,
    to.y,
    sin * to.x + cos * to.z,
  );
}

/** Writes the current position of a node (tree frame) into `out`, as drawn with this exaggeration. */
export function nodeNow(
  motion: TableMotion,
  poses: Float32Array | null,
  tree: number,
  node: number,
  out: Float64Array,
  exaggeration = 1,
): void {
  const { stride, modes, basis, rest_m } = motion;
  for (let axis = 0; axis < 3; axis++) {
    let moved = 0;
    const row = (node * 3 + axis) * stride;
    if (poses) for (let k = 0; k < modes; k++) moved += basis[row + k] * poses[tree * stride + k];
    out[axis] = rest_m[node * 3 + axis] + exaggeration * moved;
  }
}

const place = new Float64Array(3);

/** Distance along the ray to a tree, m. */
function entry(group: PickGroup, tree: number, ray: Ray): number {
  const { instances, bounds, motion, nodeRadius_m, poses, exaggeration } = group;
  const scale = instances.data[tree * INSTANCE_FLOATS + 6];
  const [ox, oy, oz, dx, dy, dz] = ownRay(instances.data, tree, ray);
  if (!motion) return crownEntry(bounds, ox, oy, oz, dx, dy, dz) * scale;
  let nearest = Number.POSITIVE_INFINITY;
  for (let node = 0; node < motion.nodes; node++) {
    nodeNow(motion, poses, tree, node, place, exaggeration);
    const t = ballEntry(ox - place[0], oy - place[1], oz - place[2], dx, dy, dz, nodeRadius_m[node]);
    if (t < nearest) nearest = t;
  }
  return nearest * scale;
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

/** Radius of the sphere around a node, relative to its farthest vertex: 1 covers all vertices, less the dense part. */
const FILL = 0.75;

/** Extent of the mesh around each node, from the vertices bound to it (xyz packed, table order). */
export function nodeRadii(positions: readonly ArrayLike<number>[], motion: TableMotion): Float32Array {
  const radius_m = new Float32Array(motion.nodes);
  let vertex = 0;
  for (const part of positions) {
    for (let i = 0; i < part.length; i += 3, vertex++) {
      const node = motion.vertexNode[vertex];
      const [x, y, z] = [0, 1, 2].map((axis) => part[i + axis] - motion.rest_m[node * 3 + axis]);
      radius_m[node] = Math.max(radius_m[node], FILL * Math.hypot(x, y, z));
    }
  }
  return radius_m;
}
