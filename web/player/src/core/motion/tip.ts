/** Displacement of a tree's tip, computed from its row of a pose buffer. */

export interface TipOf {
  readonly stride: number;
  readonly modes: number;
  /** [nodes, 3, stride] displacement in m per unit of each coordinate, tree frame. */
  readonly basis: Float32Array;
}

const known = new WeakMap<Float32Array, number>();

/** The node that moves most with the first two modes: the end of the leading shoot. */
export function tipNode(of: TipOf): number {
  const node = known.get(of.basis) ?? findTip(of);
  known.set(of.basis, node);
  return node;
}

function findTip({ stride, basis }: TipOf): number {
  let best = 0;
  let most = -1;
  for (let node = 0; node < basis.length / (3 * stride); node++) {
    let sum = 0;
    for (let axis = 0; axis < 3; axis++) {
      for (let k = 0; k < 2; k++) sum += basis[(node * 3 + axis) * stride + k] ** 2;
    }
    if (sum > most) {
      most = sum;
      best = node;
    }
  }
  return best;
}

/** Distance of a tree's tip from rest (m); `pose` is the tree's row, `scale` its size. */
export function tipDisplacement_m(of: TipOf, node: number, pose: ArrayLike<number>, scale: number): number {
  let sum = 0;
  for (let axis = 0; axis < 3; axis++) {
    let d = 0;
    for (let k = 0; k < of.modes; k++) d += of.basis[(node * 3 + axis) * of.stride + k] * pose[k];
    sum += d * d;
  }
  return scale * Math.sqrt(sum);
}

/** Group and index of the tree nearest to a position; null without trees. `placements`: x, z, yaw, scale per tree. */
export function nearestTree(
  placements: readonly Float32Array[],
  x: number,
  z: number,
): { group: number; tree: number } | null {
  let best: { group: number; tree: number } | null = null;
  let least = Number.POSITIVE_INFINITY;
  placements.forEach((placement, group) => {
    for (let tree = 0; tree < placement.length / 4; tree++) {
      const distance = (placement[tree * 4] - x) ** 2 + (placement[tree * 4 + 1] - z) ** 2;
      if (distance >= least) continue;
      least = distance;
      best = { group, tree };
    }
  });
  return best;
}
