/** The vertex of a tree that a ray passes, and places in the tree's frame and in the world. Pure. */

import type { TableMotion } from "galewood/client";
import { poseNow } from "galewood/motion";
import type { Ray, TreePart, UprightTrees } from "galewood/trees";
import { INSTANCE_FLOATS, leanAt, ownRay } from "galewood/trees";

export type Vector = [number, number, number];

/** A tree with its mesh, in one pose. */
export interface GrabbedTree {
  readonly parts: readonly TreePart[];
  readonly motion: TableMotion;
  readonly instances: UprightTrees;
  readonly poses: Float32Array | null;
  readonly tree: number;
  readonly leafless: boolean;
  /** Factor of the displacements on screen; 1 if omitted. */
  readonly exaggeration?: number;
}

/** Vertices this near to the ray are hit, m, also at a distance. */
const NEAR_M = 0.05;
/** One metre beside the ray counts as much as this many metres farther away. */
const ASIDE_WEIGHT = 4;

/** Place of a vertex at rest, in the tree's frame. */
export function restOf(parts: readonly TreePart[], vertex: number): Vector {
  let first = 0;
  for (const { position, vertices } of parts) {
    if (vertex < first + vertices) {
      const at = 3 * (vertex - first);
      return [position.array[at], position.array[at + 1], position.array[at + 2]];
    }
    first += vertices;
  }
  throw new RangeError(`the mesh has no vertex ${vertex}`);
}

/** The vertex nearest to a ray within `slope` (radians) of it; null if there is none. */
export function grabbedVertex(of: GrabbedTree, ray: Ray, slope: number): number | null {
  const { parts, motion, poses, tree } = of;
  const [ox, oy, oz, dx, dy, dz] = ownRay(of.instances, tree, ray);
  const pose = poseNow(motion, poses, tree * motion.stride, of.exaggeration ?? 1);
  const place = new Float64Array(3);
  let best: number | null = null;
  let least = Number.POSITIVE_INFINITY;
  let first = 0;
  for (const { kind, position, hold, vertices } of parts) {
    const { array } = position;
    for (let v = 0; v < vertices && !(kind === "leaves" && of.leafless); v++) {
      pose.place(first + hold[v], array[3 * v], array[3 * v + 1], array[3 * v + 2], place);
      const [px, py, pz] = [place[0] - ox, place[1] - oy, place[2] - oz];
      const along = px * dx + py * dy + pz * dz;
      if (along <= 0) continue;
      const aside = Math.sqrt(Math.max(0, px * px + py * py + pz * pz - along * along));
      if (aside > NEAR_M + slope * along) continue;
      const score = along + ASIDE_WEIGHT * aside;
      if (score >= least) continue;
      least = score;
      best = first + v;
    }
    first += vertices;
  }
  return best;
}

/** A vertex at a node: the first of those whose joint rests nearest to it. Not every node has a joint of its own. */
export function vertexAt(
  { vertexJoint, jointRest_m, rest_m }: Pick<TableMotion, "vertexJoint" | "jointRest_m" | "rest_m">,
  node: number,
): number {
  let best = 0;
  let least = Number.POSITIVE_INFINITY;
  for (const [vertex, joint] of vertexJoint.entries()) {
    const far_m = Math.hypot(
      jointRest_m[3 * joint] - rest_m[3 * node],
      jointRest_m[3 * joint + 1] - rest_m[3 * node + 1],
      jointRest_m[3 * joint + 2] - rest_m[3 * node + 2],
    );
    if (far_m >= least) continue;
    least = far_m;
    best = vertex;
  }
  return best;
}

/** A place in the tree's frame, in the world. */
export function toWorld(of: UprightTrees, tree: number, [x, y, z]: Vector): Vector {
  const at = tree * INSTANCE_FLOATS;
  const { data } = of;
  const [cos, sin, scale] = [data[at + 4], data[at + 5], data[at + 6]];
  const [leanX, leanZ] = leanAt(of, tree);
  const up = scale * y;
  return [
    data[at] + cos * x + sin * z + leanX * up,
    data[at + 1] + up,
    data[at + 2] + cos * z - sin * x + leanZ * up,
  ];
}

/** A place in the world, in the tree's frame. */
export function toTree(of: UprightTrees, tree: number, [wx, wy, wz]: Vector): Vector {
  const at = tree * INSTANCE_FLOATS;
  const { data } = of;
  const [cos, sin, scale] = [data[at + 4], data[at + 5], data[at + 6]];
  const [leanX, leanZ] = leanAt(of, tree);
  const y = wy - data[at + 1];
  const [x, z] = [wx - data[at] - leanX * y, wz - data[at + 2] - leanZ * y];
  const square = scale * scale;
  return [(cos * x - sin * z) / square, y / scale, (sin * x + cos * z) / square];
}

/** Displacement of a vertex as drawn: of the joint that holds it, of its turn about the joint, and of both. */
export interface Displaced {
  readonly held: Vector;
  readonly swung: Vector;
  readonly all: Vector;
}

/** Displacement of a vertex from rest: by its joint, and by the force of a pull beyond that. */
export function displacementOf(
  { motion, poses, tree, parts, exaggeration = 1 }: Omit<GrabbedTree, "data" | "leafless">,
  vertex: number,
  pull: { readonly field: Float32Array | null; readonly force_N: ArrayLike<number> } | null,
): Displaced {
  const pose = poseNow(motion, poses, tree * motion.stride, exaggeration);
  const rest = restOf(parts, vertex);
  const place = new Float64Array(3);
  pose.place(vertex, ...rest, place);
  const joint = 3 * motion.vertexJoint[vertex];
  const { field = null, force_N = [] } = pull ?? {};
  const held: number[] = [];
  const swung: number[] = [];
  for (let axis = 0; axis < 3; axis++) {
    const moved = pose.jointMoved[joint + axis];
    swung.push(place[axis] - rest[axis] - moved);
    const at = 9 * vertex + axis;
    const more = field ? field[at] * force_N[0] + field[at + 3] * force_N[1] + field[at + 6] * force_N[2] : 0;
    held.push(moved + exaggeration * more);
  }
  const [x, y, z] = held.map((value, axis) => value + swung[axis]);
  return { held: held as Vector, swung: swung as Vector, all: [x, y, z] };
}
