/** Carries poses over to a new plan: the displayed pose of each tree in the coordinates of its new group. Pure. */

import { poseStride } from "../../core/motion/poseStride";
import { jointRow } from "../../core/table/jointRow";
import type { Table } from "../../core/table/table";

/** A displayed group. */
export interface ShownGroup {
  /** Id of the species or upload, independent of its table. */
  readonly key: string;
  readonly table: Table;
  readonly ids: ArrayLike<number>;
}

/** Initial poses; `known` is 1 for trees that existed before. */
export interface CarriedGroup {
  readonly poses: Float32Array;
  readonly known: Uint8Array;
}

/** Previous index of each tree, −1 for a new one. */
export function rowsBefore(before: ArrayLike<number>, now: ArrayLike<number>): Int32Array {
  const index = new Map(Array.from(before, (id, row) => [id, row] as const));
  return Int32Array.from(now, (id) => index.get(id) ?? -1);
}

/** The displayed poses of the group with the same key, in the coordinates of this one; null if there was none. */
export function carryGroup(
  group: ShownGroup,
  before: readonly ShownGroup[],
  shown: readonly Float32Array[],
): CarriedGroup | null {
  const g = before.findIndex(({ key }) => key === group.key);
  if (g < 0) return null;
  const old = before[g];
  const { modes } = group.table.metadata;
  const stride = poseStride(modes);
  const rows = rowsBefore(old.ids, group.ids);
  const poses = new Float32Array(group.ids.length * stride);
  const known = Uint8Array.from(rows, (row) => (row < 0 ? 0 : 1));
  const turn = old.table === group.table ? null : poseTransfer(old.table, group.table);
  if (!turn && old.table !== group.table) return null;
  const oldModes = old.table.metadata.modes;
  const oldStride = poseStride(oldModes);
  rows.forEach((row, tree) => {
    if (row < 0) return;
    const from = shown[g].subarray(row * oldStride, row * oldStride + oldModes + 1);
    const to = poses.subarray(tree * stride, tree * stride + modes + 1);
    if (turn) applyTransfer(turn, from.subarray(0, oldModes), to);
    else to.set(from);
    to[modes] = from[oldModes];
  });
  return { poses, known };
}

const MOST_VERTICES = 1500;

/**
 * [new modes, old modes]: maps a pose to the new table's coordinates so that the render vertices move as before (least
 * squares). null if the tables belong to different meshes.
 */
export function poseTransfer(from: Table, to: Table): Float64Array | null {
  if (from.vertexJoint.length !== to.vertexJoint.length) return null;
  const r = to.metadata.modes;
  const s = from.metadata.modes;
  const normal = new Float64Array(r * r);
  const right = new Float64Array(r * s);
  const step = Math.max(1, Math.floor(to.vertexJoint.length / MOST_VERTICES));
  const [a, b] = [new Float64Array(3 * r), new Float64Array(3 * s)];
  for (let vertex = 0; vertex < to.vertexJoint.length; vertex += step) {
    jointRow(to, to.vertexJoint[vertex], a);
    jointRow(from, from.vertexJoint[vertex], b);
    for (let axis = 0; axis < 3; axis++) {
      for (let i = 0; i < r; i++) {
        const row = a[axis * r + i];
        for (let j = 0; j <= i; j++) normal[i * r + j] += row * a[axis * r + j];
        for (let j = 0; j < s; j++) right[i * s + j] += row * b[axis * s + j];
      }
    }
  }
  return solve(normal, right, r, s);
}

/** Solves N X = B by Cholesky. Only the lower half of N [r, r] is used; B [r, s] is overwritten; null modes give 0. */
function solve(normal: Float64Array, right: Float64Array, r: number, s: number): Float64Array {
  const floor = 1e-9 * Math.max(...Array.from({ length: r }, (_, i) => normal[i * r + i]), 1e-30);
  for (let i = 0; i < r; i++) {
    normal[i * r + i] += floor;
    for (let j = 0; j <= i; j++) {
      let sum = normal[i * r + j];
      for (let k = 0; k < j; k++) sum -= normal[i * r + k] * normal[j * r + k];
      normal[i * r + j] = i === j ? Math.sqrt(Math.max(sum, floor)) : sum / normal[j * r + j];
    }
  }
  for (let column = 0; column < s; column++) {
    for (let i = 0; i < r; i++) {
      let sum = right[i * s + column];
      for (let k = 0; k < i; k++) sum -= normal[i * r + k] * right[k * s + column];
      right[i * s + column] = sum / normal[i * r + i];
    }
    for (let i = r - 1; i >= 0; i--) {
      let sum = right[i * s + column];
      for (let k = i + 1; k < r; k++) sum -= normal[k * r + i] * right[k * s + column];
      right[i * s + column] = sum / normal[i * r + i];
    }
  }
  return right;
}

function applyTransfer(turn: Float64Array, from: Float32Array, to: Float32Array): void {
  for (let i = 0; i < turn.length / from.length; i++) {
    let sum = 0;
    for (let j = 0; j < from.length; j++) sum += turn[i * from.length + j] * from[j];
    to[i] = sum;
  }
}
