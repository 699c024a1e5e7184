/** Points that move with the nodes of a table, such as the vertices of its finite elements. Pure. */

/** Each point follows this many nodes, weighted by the inverse square of their distance. */
const NEAREST_NODES = 3;
/** A node nearer than this is as good as the point itself, m. */
const SAME_M = 1e-3;

export class NodeBinding {
  readonly count: number;
  private readonly node: Uint16Array;
  private readonly weight: Float32Array;

  /**
   * `points` and `rest_m` hold xyz of the points and of the nodes at rest, in the tree's frame. Below the lowest node
   * the motion fades towards the clamped root, like the deflection of a cantilever.
   */
  constructor(points: Float32Array, rest_m: Float32Array) {
    this.count = points.length / 3;
    const nodes = rest_m.length / 3;
    const near = Math.min(NEAREST_NODES, nodes);
    this.node = new Uint16Array(this.count * NEAREST_NODES);
    this.weight = new Float32Array(this.count * NEAREST_NODES);
    let lowest_m = Number.POSITIVE_INFINITY;
    for (let node = 0; node < nodes; node++) lowest_m = Math.min(lowest_m, rest_m[3 * node + 1]);
    for (let point = 0; point < this.count; point++) {
      const fade = Math.min(1, Math.max(0, points[3 * point + 1] / Math.max(1e-6, lowest_m))) ** 2;
      this.bind(point, points, rest_m, near, fade);
    }
  }

  private bind(point: number, points: Float32Array, rest_m: Float32Array, near: number, fade: number): void {
    const best = new Array<number>(near).fill(-1);
    const gap = new Array<number>(near).fill(Number.POSITIVE_INFINITY);
    for (let node = 0; node < rest_m.length / 3; node++) {
      let square = 0;
      for (let axis = 0; axis < 3; axis++)
        square += (points[3 * point + axis] - rest_m[3 * node + axis]) ** 2;
      if (square >= gap[near - 1]) continue;
      let at = near - 1;
      for (; at > 0 && gap[at - 1] > square; at--) {
        gap[at] = gap[at - 1];
        best[at] = best[at - 1];
      }
      gap[at] = square;
      best[at] = node;
    }
    const shares = gap.map((square) => 1 / Math.max(SAME_M ** 2, square));
    const sum = shares.reduce((total, share) => total + share, 0);
    for (let k = 0; k < near; k++) {
      this.node[point * NEAREST_NODES + k] = best[k];
      this.weight[point * NEAREST_NODES + k] = (fade * shares[k]) / sum;
    }
  }

  /** Writes the displacements of the points, given those of the nodes (xyz each). */
  displace(moved: Float32Array, out: Float32Array): void {
    const { node, weight } = this;
    for (let point = 0; point < this.count; point++) {
      for (let axis = 0; axis < 3; axis++) {
        let sum = 0;
        for (let k = point * NEAREST_NODES; k < (point + 1) * NEAREST_NODES; k++)
          sum += weight[k] * moved[3 * node[k] + axis];
        out[3 * point + axis] = sum;
      }
    }
  }
}
