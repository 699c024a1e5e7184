/** The poses of one frame as the worker sends them: only those that changed, distant trees rounded. Pure. */
import { FAR_COORDINATES } from "../table/leadingCoordinates";
import type { Changed } from "./leveledTrees";

/** Numbers of a distant tree: the leading coordinates in units of FAR_QUANTUM_M, and the wind in units of FAR_WIND_M_S. */
const FAR_NUMBERS = FAR_COORDINATES + 1;
/** Its root mean square is a third of this: 0.15 mm. */
const FAR_QUANTUM_M = 5e-4;
const FAR_QUANTA_PER_M = 1 / FAR_QUANTUM_M;
const FAR_WIND_M_S = 0.01;
const FAR_WINDS_PER_M_S = 1 / FAR_WIND_M_S;
const NO_COORDINATES = new Uint16Array(0);
const MOST_INT16 = 32_767;
/** Room of new arrays relative to what they hold, so that they seldom grow. */
const ROOM_SHARE = 1.25;

/** What one group has in a packet. */
interface PartOfGroup {
  /** Number of rows; whether these are all trees of the group, which are then not listed. */
  readonly near: number;
  readonly all: boolean;
  /** Numbers of distant trees by level, and the frames after which they reach their poses. */
  readonly far: readonly number[];
  readonly periods: readonly number[];
}

/** The groups one after the other; the arrays may be longer than what they hold. */
export interface PosePacket {
  readonly groups: readonly PartOfGroup[];
  /** Rows of `poseStride(modes)` floats of near trees, and their indices. */
  readonly rows: Float32Array<ArrayBuffer>;
  readonly near: Uint32Array<ArrayBuffer>;
  /** FAR_NUMBERS of each distant tree, and their indices. */
  readonly leading: Int16Array<ArrayBuffer>;
  readonly far: Uint32Array<ArrayBuffer>;
}

/** The poses of a group in the worker. */
export interface PackedGroup {
  readonly poses: Float32Array;
  readonly stride: number;
  readonly modes: number;
  /** The trees whose poses are new; null: all. */
  readonly changed: Changed | null;
}

export const packetBuffers = ({ rows, near, leading, far }: PosePacket): ArrayBuffer[] =>
  [rows, near, leading, far].map(({ buffer }) => buffer);

/** Bytes that a packet holds. */
export function packetBytes(groups: readonly PackedGroup[]): number {
  const { floats, near, far } = sizesOf(groups);
  return 4 * floats + 4 * near + (2 * FAR_NUMBERS + 4) * far;
}

function sizesOf(groups: readonly PackedGroup[]): { floats: number; near: number; far: number } {
  const sizes = { floats: 0, near: 0, far: 0 };
  for (const { poses, stride, changed } of groups) {
    sizes.floats += changed ? changed.near.length * stride : poses.length;
    sizes.near += changed?.near.length ?? 0;
    for (const trees of changed?.far ?? []) sizes.far += trees.length;
  }
  return sizes;
}

/** Packs the new poses, into the arrays of an earlier packet where they are long enough. */
export function packPoses(groups: readonly PackedGroup[], spare: PosePacket | null): PosePacket {
  const sizes = sizesOf(groups);
  const grown = (length: number) => Math.ceil(ROOM_SHARE * length);
  const rows = fits(spare?.rows, sizes.floats) ?? new Float32Array(grown(sizes.floats));
  const near = fits(spare?.near, sizes.near) ?? new Uint32Array(grown(sizes.near));
  const leading =
    fits(spare?.leading, FAR_NUMBERS * sizes.far) ?? new Int16Array(grown(FAR_NUMBERS * sizes.far));
  const far = fits(spare?.far, sizes.far) ?? new Uint32Array(grown(sizes.far));
  const packet = { groups: groups.map(partOf), rows, near, leading, far };
  const at = { row: 0, near: 0, far: 0 };
  for (const group of groups) {
    packNear(group, packet, at);
    for (const trees of group.changed?.far ?? []) {
      far.set(trees, at.far);
      packFar(group, trees, leading, at.far);
      at.far += trees.length;
    }
  }
  return packet;
}

const fits = <A extends { readonly length: number }>(array: A | undefined, length: number): A | null =>
  array && array.length >= length ? array : null;

function partOf({ poses, stride, changed }: PackedGroup): PartOfGroup {
  if (!changed) return { near: poses.length / stride, all: true, far: [], periods: [] };
  const { near, far, periods } = changed;
  return { near: near.length, all: false, far: far.map(({ length }) => length), periods };
}

function packNear(
  { poses, stride, changed }: PackedGroup,
  { rows, near }: PosePacket,
  at: { row: number; near: number },
): void {
  if (!changed) {
    rows.set(poses, at.row);
    at.row += poses.length;
    return;
  }
  near.set(changed.near, at.near);
  at.near += changed.near.length;
  for (const tree of changed.near) {
    const from = tree * stride;
    for (let k = 0; k < stride; k++) rows[at.row + k] = poses[from + k];
    at.row += stride;
  }
}

function packFar(
  { poses, stride, modes, changed }: PackedGroup,
  trees: Uint32Array,
  out: Int16Array,
  first: number,
): void {
  const coordinates = changed?.coordinates ?? NO_COORDINATES;
  for (let k = 0, to = FAR_NUMBERS * first; k < trees.length; k++, to += FAR_NUMBERS) {
    const from = trees[k] * stride;
    for (let c = 0; c < coordinates.length; c++)
      out[to + c] = rounded(FAR_QUANTA_PER_M * poses[from + coordinates[c]]);
    out[to + FAR_COORDINATES] = rounded(FAR_WINDS_PER_M_S * poses[from + modes]);
  }
}

/** The nearest integer of 16 bits. */
const rounded = (value: number): number =>
  Math.floor(Math.max(-MOST_INT16, Math.min(MOST_INT16, value)) + 0.5);

/** Coordinate `k` of those of a distant tree, m. */
export const coordinateOf = (leading: Int16Array, tree: number, k: number): number =>
  FAR_QUANTUM_M * leading[FAR_NUMBERS * tree + k];

/** The wind at a distant tree, m/s. */
export const windOf = (leading: Int16Array, tree: number): number =>
  FAR_WIND_M_S * leading[FAR_NUMBERS * tree + FAR_COORDINATES];
