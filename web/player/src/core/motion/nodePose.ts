/**
 * Where the vertices of a table are drawn, on the CPU. Pure. The shaders of trees/ do the same;
 * precompute/galewood/solid/skinning/node_poses.py explains it.
 */
import { LONGEST_LINK, MOST_LINK_STRETCH } from "../constants";

/** The part of a table's motion that decides where vertices are drawn: n nodes, j joints. */
export interface Jointed {
  readonly stride: number;
  readonly modes: number;
  readonly nodes: number;
  /** [n, 3, stride] displacement in m, and rotation vector, per unit of each coordinate. */
  readonly basis: Float32Array;
  readonly turn: Float32Array;
  /** [n, 3] rest position. */
  readonly rest_m: Float32Array;
  /** [n] node before it on its branch, which comes earlier; its own index: none. */
  readonly parent: Uint16Array;
  /** [j, 2] nodes, [j] share of the second, and [j, 3] rest position of each joint. */
  readonly jointNodes: Uint16Array;
  readonly jointShare: Float32Array;
  readonly jointRest_m: Float32Array;
  /** Joint of each render vertex. */
  readonly vertexJoint: Uint16Array;
}

/** Displacements and rotations of the nodes and joints of a tree in one pose. */
export class NodePose {
  /** [n, 3] displacement, m, and rotation vectors. */
  readonly moved: Float32Array;
  readonly turned: Float32Array;
  /** [j, 3] the same of the joints. */
  readonly jointMoved: Float32Array;
  readonly jointTurned: Float32Array;
  private readonly excess: Float32Array;

  constructor(private readonly of: Jointed) {
    this.moved = new Float32Array(3 * of.nodes);
    this.turned = new Float32Array(3 * of.nodes);
    this.excess = new Float32Array(3 * of.nodes);
    this.jointMoved = new Float32Array(3 * of.jointShare.length);
    this.jointTurned = new Float32Array(3 * of.jointShare.length);
  }

  /** Takes the pose of a tree whose coordinates begin at `first`; null: at rest. */
  take(poses: ArrayLike<number> | null, first = 0, factor = 1): this {
    this.expand(this.of.basis, poses, first, factor, this.moved);
    this.expand(this.of.turn, poses, first, factor, this.turned);
    this.shorten();
    this.blend(this.moved, this.jointMoved);
    this.blend(this.turned, this.jointTurned);
    return this;
  }

  private expand(
    rows: Float32Array,
    poses: ArrayLike<number> | null,
    first: number,
    factor: number,
    out: Float32Array,
  ): void {
    const { stride, modes } = this.of;
    for (let row = 0; row < out.length; row++) {
      let sum = 0;
      if (poses) for (let k = 0; k < modes; k++) sum += rows[row * stride + k] * poses[first + k];
      out[row] = factor * sum;
    }
  }

  /** Takes what links between nodes have in excess off the nodes and all that come after them, and off the rotations. */
  private shorten(): void {
    const { parent, rest_m, nodes } = this.of;
    const { moved, turned, excess } = this;
    const now = [0, 0, 0];
    for (let node = 0; node < nodes; node++) {
      const before = parent[node];
      let squared = 0;
      let rest = 0;
      for (let axis = 0; axis < 3; axis++) {
        const link = rest_m[3 * node + axis] - rest_m[3 * before + axis];
        now[axis] = link + moved[3 * node + axis] - moved[3 * before + axis];
        squared += now[axis] ** 2;
        rest += link * link;
      }
      const length = Math.sqrt(squared);
      const stretch = Math.min(MOST_LINK_STRETCH, Math.max(1, length / Math.max(Math.sqrt(rest), 1e-12)));
      const share =
        before === node ? 0 : Math.max(0, 1 - (LONGEST_LINK * Math.sqrt(rest)) / Math.max(length, 1e-12));
      for (let axis = 0; axis < 3; axis++) {
        excess[3 * node + axis] = share * now[axis] + (before === node ? 0 : excess[3 * before + axis]);
        turned[3 * node + axis] /= stretch;
      }
    }
    for (let i = 0; i < moved.length; i++) moved[i] -= excess[i];
  }

  private blend(nodes: Float32Array, joints: Float32Array): void {
    const { jointNodes, jointShare } = this.of;
    for (const [joint, share] of jointShare.entries()) {
      const [a, b] = [3 * jointNodes[2 * joint], 3 * jointNodes[2 * joint + 1]];
      for (let axis = 0; axis < 3; axis++)
        joints[3 * joint + axis] = (1 - share) * nodes[a + axis] + share * nodes[b + axis];
    }
  }

  /** Writes where a vertex that rests at x, y, z is drawn. */
  place(vertex: number, x: number, y: number, z: number, out: Float64Array): void {
    const { vertexJoint, jointRest_m } = this.of;
    const { jointMoved, jointTurned } = this;
    const at = 3 * vertexJoint[vertex];
    const [px, py, pz] = [jointRest_m[at], jointRest_m[at + 1], jointRest_m[at + 2]];
    turn(x - px, y - py, z - pz, jointTurned[at], jointTurned[at + 1], jointTurned[at + 2], out);
    out[0] += px + jointMoved[at];
    out[1] += py + jointMoved[at + 1];
    out[2] += pz + jointMoved[at + 2];
  }
}

const known = new WeakMap<Jointed, NodePose>();

/** The pose of one tree, in arrays that the next call for the same table overwrites. */
export function poseNow(
  of: Jointed,
  given: ArrayLike<number> | null,
  first: number,
  factor: number,
): NodePose {
  const pose = known.get(of) ?? new NodePose(of);
  known.set(of, pose);
  return pose.take(given, first, factor);
}

/** Turns an arm by a rotation vector, whose length is about the sine of the angle. */
export function turn(
  x: number,
  y: number,
  z: number,
  wx: number,
  wy: number,
  wz: number,
  out: Float64Array,
): void {
  const squared = wx * wx + wy * wy + wz * wz;
  const less = 1 / Math.sqrt(Math.sqrt(1 + squared * squared));
  const [a, b, c] = [less * wx, less * wy, less * wz];
  const cosine = Math.sqrt(Math.max(0, 1 - less * less * squared));
  const along = (a * x + b * y + c * z) / (1 + cosine);
  out[0] = cosine * x + b * z - c * y + along * a;
  out[1] = cosine * y + c * x - a * z + along * b;
  out[2] = cosine * z + a * y - b * x + along * c;
}
