/** The vertex of a tree that a ray passes, and places in the tree's frame and in the world. Pure. */
import type { Ray } from "../../core/math/groundRay";
import type { TableMotion } from "../../worker/protocol";
import { INSTANCE_FLOATS } from "./instanceData";
import type { TreePart } from "./mesh/treeMesh";
import { nodeNow, ownRay } from "./treePick";

export type Vector = [number, number, number];

/** A tree with its mesh, in one pose. */
export interface GrabbedTree {
  readonly parts: readonly TreePart[];
  readonly motion: TableMotion;
  /** Rows of INSTANCE_FLOATS. */
  readonly data: Float32Array;
  readonly poses: Float32Array | null;
  readonly tree: number;
  readonly leafless: boolean;
  /** Factor of the displacements on screen; 1 if omitted. */
  readonly exaggeration?: number;
}

/** Vertices this near to the ray are hit, m, also at a distance. */
const NEAR_M = 0.05;
/** One metre beside the ray counts as much as this many metres farther away. */
const ASIDE = 4;

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
  const [ox, oy, oz, dx, dy, dz] = ownRay(of.data, tree, ray);
  const nodes = new Float64Array(3 * motion.nodes);
  const place = new Float64Array(3);
  for (let node = 0; node < motion.nodes; node++) {
    nodeNow(motion, poses, tree, node, place, of.exaggeration);
    for (let axis = 0; axis < 3; axis++)
      nodes[3 * node + axis] = place[axis] - motion.rest_m[3 * node + axis];
  }
  let best: number | null = null;
  let least = Number.POSITIVE_INFINITY;
  let first = 0;
  for (const { kind, position, hold, vertices } of parts) {
    const { array } = position;
    for (let v = 0; v < vertices && !(kind === "leaves" && of.leafless); v++) {
      const node = 3 * motion.vertexNode[first + hold[v]];
      const px = array[3 * v] + nodes[node] - ox;
      const py = array[3 * v + 1] + nodes[node + 1] - oy;
      const pz = array[3 * v + 2] + nodes[node + 2] - oz;
      const along = px * dx + py * dy + pz * dz;
      if (along <= 0) continue;
      const aside = Math.sqrt(Math.max(0, px * px + py * py + pz * pz - along * along));
      if (aside > NEAR_M + slope * along) continue;
      const score = along + ASIDE * aside;
      if (score >= least) continue;
      least = score;
      best = first + v;
    }
    first += vertices;
  }
  return best;
}

/** A place in the tree's frame, in the world. */
export function toWorld(data: Float32Array, tree: number, [x, y, z]: Vector): Vector {
  const at = tree * INSTANCE_FLOATS;
  const [cos, sin, scale] = [data[at + 4], data[at + 5], data[at + 6]];
  return [data[at] + cos * x + sin * z, data[at + 1] + scale * y, data[at + 2] + cos * z - sin * x];
}

/** A place in the world, in the tree's frame. */
export function toTree(data: Float32Array, tree: number, [wx, wy, wz]: Vector): Vector {
  const at = tree * INSTANCE_FLOATS;
  const [cos, sin, scale] = [data[at + 4], data[at + 5], data[at + 6]];
  const [x, y, z] = [wx - data[at], wy - data[at + 1], wz - data[at + 2]];
  const square = scale * scale;
  return [(cos * x - sin * z) / square, y / scale, (sin * x + cos * z) / square];
}

/** Displacement of a vertex from rest: by its node, and by the force of a pull beyond it. */
export function displacementOf(
  { motion, poses, tree }: Pick<GrabbedTree, "motion" | "poses" | "tree">,
  vertex: number,
  pull: { readonly field: Float32Array | null; readonly force_N: ArrayLike<number> } | null,
): Vector {
  const node = motion.vertexNode[vertex];
  const place = new Float64Array(3);
  nodeNow(motion, poses, tree, node, place);
  const [x, y, z] = [0, 1, 2].map((axis) => {
    const modes = place[axis] - motion.rest_m[3 * node + axis];
    const { field = null, force_N = [] } = pull ?? {};
    if (!field) return modes;
    const at = 9 * vertex + axis;
    return modes + field[at] * force_N[0] + field[at + 3] * force_N[1] + field[at + 6] * force_N[2];
  });
  return [x, y, z];
}
