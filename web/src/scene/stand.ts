/** The trees of one species as packed arrays, and which of them a frame draws. Pure. */
import type { Place } from "./planting";

/** Floats per tree in `Stand.data`: x y z slot | s·cos s·sin s phase | tint rgb, strength. */
export const INSTANCE_FLOATS = 12;

export interface Stand {
  readonly count: number;
  readonly data: Float32Array;
  /** x, z, yaw, scale of each tree: what the lookup needs. */
  readonly placement: Float32Array<ArrayBuffer>;
}

export type Tint = (treeId: number) => readonly [number, number, number, number];

export function makeStand(
  places: readonly Place[],
  ground: (x: number, z: number) => number,
  tint: Tint,
): Stand {
  const data = new Float32Array(places.length * INSTANCE_FLOATS);
  const placement = new Float32Array(places.length * 4);
  places.forEach((place, i) => {
    const { x_m, z_m, yaw_rad, scale } = place;
    const cos = scale * Math.cos(yaw_rad);
    const sin = scale * Math.sin(yaw_rad);
    const y_m = ground(x_m, z_m) - 0.06 * scale;
    data.set([x_m, y_m, z_m, 0, cos, sin, scale, yaw_rad * 17, ...tint(place.id)], i * INSTANCE_FLOATS);
    placement.set([x_m, z_m, yaw_rad, scale], i * 4);
  });
  return { count: places.length, data, placement };
}

/** Plane coefficients (a, b, c, d), positive inside: six of the camera's frustum. */
export type Planes = readonly { normal: { x: number; y: number; z: number }; constant: number }[];

export interface View {
  readonly planes: Planes;
  readonly eye: { x: number; y: number; z: number };
  /** Towards the sun. */
  readonly sun: { x: number; y: number; z: number };
  /** Distances in m at which levels 1 and 2 begin, for a tree of scale 1. */
  readonly levelFrom_m: readonly [number, number];
  /** Trees out of sight within this distance still cast shadows. */
  readonly shadow_m: number;
}

/** Bounds of a species at scale 1: a sphere about half the height, with room for sway. */
export interface Bounds {
  readonly height_m: number;
  readonly radius_m: number;
}

/** Ranges of the draw order: per level the visible trees, then those only drawn into the shadow map. */
export interface DrawList {
  readonly order: Uint32Array;
  readonly start: Uint32Array;
  readonly visible: Uint32Array;
  readonly shadowOnly: Uint32Array;
  drawn: number;
}

export const LEVEL_COUNT = 3;

export function makeDrawList(capacity: number): DrawList {
  const counts = () => new Uint32Array(LEVEL_COUNT);
  return {
    order: new Uint32Array(capacity),
    start: counts(),
    visible: counts(),
    shadowOnly: counts(),
    drawn: 0,
  };
}

function inside(planes: Planes, x: number, y: number, z: number, radius: number): boolean {
  for (const { normal, constant } of planes) {
    if (normal.x * x + normal.y * y + normal.z * z + constant < -radius) return false;
  }
  return true;
}

const HIDDEN = 255;
/** Bins of distance: trees are drawn near to far, so that what is hidden is not shaded. */
const BINS = 16;
const BIN_M = 12;
const CLASSES = 2 * LEVEL_COUNT * BINS;

/** Class of a tree: level, seen or only its shadow, bin of distance; or HIDDEN. */
function classify(data: Float32Array, at: number, bounds: Bounds, view: View): number {
  const scale = data[at + 6];
  const middle_m = 0.5 * bounds.height_m * scale;
  const radius_m = Math.hypot(middle_m, bounds.radius_m * scale) * 1.1;
  const x = data[at];
  const y = data[at + 1] + middle_m;
  const z = data[at + 2];
  const distance_m = Math.hypot(x - view.eye.x, y - view.eye.y, z - view.eye.z);
  const near = distance_m / scale;
  const level = near < view.levelFrom_m[0] ? 0 : near < view.levelFrom_m[1] ? 1 : 2;
  const bin = Math.min(BINS - 1, Math.floor(distance_m / BIN_M));
  if (inside(view.planes, x, y, z, radius_m)) return 2 * level * BINS + bin;
  if (distance_m > view.shadow_m) return HIDDEN;
  const slide = middle_m / Math.max(0.15, view.sun.y);
  const shadowSeen = inside(
    view.planes,
    x - view.sun.x * slide,
    y - middle_m,
    z - view.sun.z * slide,
    radius_m + slide,
  );
  return shadowSeen ? (2 * level + 1) * BINS + bin : HIDDEN;
}

const tally = new Uint32Array(CLASSES);
const next = new Uint32Array(CLASSES);

/** Fills the draw list for a view; `classes` is scratch of one byte per tree. Allocates nothing. */
export function selectTrees(
  stand: Stand,
  bounds: Bounds,
  view: View,
  classes: Uint8Array,
  list: DrawList,
): void {
  tally.fill(0);
  for (let tree = 0; tree < stand.count; tree++) {
    classes[tree] = classify(stand.data, tree * INSTANCE_FLOATS, bounds, view);
    if (classes[tree] !== HIDDEN) tally[classes[tree]]++;
  }
  layOut(list);
  for (let tree = 0; tree < stand.count; tree++) {
    if (classes[tree] !== HIDDEN) list.order[next[classes[tree]]++] = tree;
  }
}

/** Ranges from the tally; `next` is where each class begins. */
function layOut(list: DrawList): void {
  list.visible.fill(0);
  list.shadowOnly.fill(0);
  let at = 0;
  for (let c = 0; c < CLASSES; c++) {
    const group = Math.floor(c / BINS);
    const level = group >> 1;
    if (c % (2 * BINS) === 0) list.start[level] = at;
    next[c] = at;
    (group & 1 ? list.shadowOnly : list.visible)[level] += tally[c];
    at += tally[c];
  }
  list.drawn = at;
}
