/** Mean displacement of the crowns from rest, computed from pose buffers. */

export interface SwayGroup {
  readonly count: number;
  readonly stride: number;
  readonly modes: number;
  /** [3, modes], see TableMotion. */
  readonly crownBasis: Float32Array;
  /** x, z, yaw, scale per tree. */
  readonly placement: Float32Array;
  readonly poses: Float32Array;
}

/** Adds one tree's mean crown displacement (m, world frame). */
function addTree(group: SwayGroup, tree: number, sum: [number, number, number]): void {
  const { modes, crownBasis, poses } = group;
  const own = [0, 0, 0];
  for (let axis = 0; axis < 3; axis++) {
    for (let k = 0; k < modes; k++)
      own[axis] += crownBasis[axis * modes + k] * poses[tree * group.stride + k];
  }
  const yaw = group.placement[tree * 4 + 2];
  const scale = group.placement[tree * 4 + 3];
  sum[0] += scale * (Math.cos(yaw) * own[0] + Math.sin(yaw) * own[2]);
  sum[1] += scale * own[1];
  sum[2] += scale * (Math.cos(yaw) * own[2] - Math.sin(yaw) * own[0]);
}

/** Crown displacement averaged over all trees (m, world frame); zero without trees. */
export function meanCrownDisplacement_m(groups: readonly SwayGroup[]): [number, number, number] {
  const sum: [number, number, number] = [0, 0, 0];
  let trees = 0;
  for (const group of groups) {
    for (let tree = 0; tree < group.count; tree++) addTree(group, tree, sum);
    trees += group.count;
  }
  return trees === 0 ? sum : [sum[0] / trees, sum[1] / trees, sum[2] / trees];
}
