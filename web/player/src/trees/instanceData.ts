/** The trees of one species as packed arrays. Pure. */

/** Floats per tree in `InstanceData.data`: x y z texel | s·cos s·sin s share | tint rgb, strength; or see `oriented`. */
export const INSTANCE_FLOATS = 12;

/** Buffers of trees grow in steps of this many. */
const ROOM_STEP = 256;

/** Room for `count` trees and some more, so that buffers seldom grow while the camera moves. */
export const roomFor = (count: number): number => Math.ceil((1.2 * count) / ROOM_STEP) * ROOM_STEP;

/** Room of which less than this share is used is given back: most trees far away become impostors. */
export const LEAST_USE = 0.25;

/** Whether room is too large for what is in it. */
export const isSpacious = (room: number, count: number): boolean =>
  roomFor(Math.max(1, count)) < LEAST_USE * room;

/** Copies a tree to the float `to` of another array, with its first texel in the target of pass 1 and the share of its pieces that is drawn. */
export function copyTree(
  from: Float32Array,
  tree: number,
  into: Float32Array,
  to: number,
  texel: number,
  share: number,
): void {
  const first = tree * INSTANCE_FLOATS;
  for (let k = 0; k < INSTANCE_FLOATS; k++) into[to + k] = from[first + k];
  into[to + 3] = texel;
  into[to + 7] = share;
}

/** A place for a tree. Species are assigned later, so that places never move. */
export interface Placement {
  /** Id of the place; unaffected by other trees. */
  readonly id: number;
  readonly x_m: number;
  readonly z_m: number;
  readonly yaw_rad: number;
  /** Size factor, around 1. */
  readonly scale: number;
}

export interface InstanceData {
  readonly count: number;
  readonly data: Float32Array;
  /** x, z, yaw, scale of each tree, in the format of the worker. */
  readonly placement: Float32Array<ArrayBuffer>;
  /** Id of the place of each tree. */
  readonly ids: Uint32Array<ArrayBuffer>;
  /** Whether each tree has a lean of its own (lean.ts); never of trees that stand as matrices say. */
  readonly leans: boolean;
  /**
   * Trees that stand as matrices say: [count, 12] columns of the inverse of each, and whether all are upright. Their data are x y z texel | quaternion x y,
   * largest scale, share | quaternion z w, scales along x and z over that along y; the quaternion is multiplied by the root
   * of the scale along y.
   */
  readonly oriented?: { readonly inverse: Float32Array; readonly upright: boolean };
}

export type Tint = (treeId: number) => readonly [number, number, number, number];

/** Sets the tint of every tree. */
export function setTints(instances: InstanceData, tint: Tint): void {
  instances.ids.forEach((id, i) => {
    instances.data.set(tint(id), i * INSTANCE_FLOATS + 8);
  });
}

export function createInstanceData(
  places: readonly Placement[],
  ground: (x: number, z: number) => number,
  tint: Tint,
  leans = false,
): InstanceData {
  const data = new Float32Array(places.length * INSTANCE_FLOATS);
  const placement = new Float32Array(places.length * 4);
  places.forEach((place, i) => {
    const { x_m, z_m, yaw_rad, scale } = place;
    const cos = scale * Math.cos(yaw_rad);
    const sin = scale * Math.sin(yaw_rad);
    const y_m = ground(x_m, z_m) - 0.06 * scale;
    data.set([x_m, y_m, z_m, 0, cos, sin, scale, 1, ...tint(place.id)], i * INSTANCE_FLOATS);
    placement.set([x_m, z_m, yaw_rad, scale], i * 4);
  });
  return { count: places.length, data, placement, ids: Uint32Array.from(places, ({ id }) => id), leans };
}
