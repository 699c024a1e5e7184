/** A view of one tree past the others. Pure. */
import { groundHeight_m } from "../ground/landscape";
import type { Subject, Viewpoint } from "./viewpoints";

/** Directions that are tried. */
const DIRECTION_COUNT = 48;
/** Distance of the eye in heights of the tree; at least and in addition, m. */
const DISTANCE_HEIGHTS = 1.55;
const LEAST_M = 4.5;
/** Radius of a crown relative to the tree's height. */
const CROWN_RADIUS_SHARE = 0.22;
/** What a hidden view costs, relative to one against the sun. */
const HIDDEN_COST = 4;
/** Preferred angle between the eye and the sun, as seen from the tree. */
const BESIDE_SUN_RAD = 0.7;

/** Distance of a point from the line between two others, in plan. */
function distance_m(point: Subject, from: Subject, to: { x: number; z: number }): number {
  const [dx, dz] = [to.x - from.x, to.z - from.z];
  const along = ((point.x - from.x) * dx + (point.z - from.z) * dz) / (dx * dx + dz * dz || 1);
  const t = Math.min(1, Math.max(0, along));
  return Math.hypot(point.x - from.x - t * dx, point.z - from.z - t * dz);
}

/** How much the crowns of other trees hide a tree from an eye: 1 for a trunk on the line of sight. */
function hidden(subject: Subject, eye: { x: number; z: number }, others: readonly Subject[]): number {
  let sum = 0;
  for (const other of others) {
    const apart_m = Math.hypot(other.x - subject.x, other.z - subject.z);
    if (apart_m < 0.3) continue; // the tree itself
    const crown_m = CROWN_RADIUS_SHARE * other.height_m;
    sum += Math.max(0, 1 - distance_m(other, subject, eye) / crown_m);
  }
  return sum;
}

/**
 * The view of a tree that other trees hide least, preferably from the sunny side. `aspect`: width over height of the
 * picture.
 */
export function treeView(
  subject: Subject,
  others: readonly Subject[],
  sun: { x: number; z: number },
  aspect: number,
): Viewpoint {
  const away_m = Math.max(LEAST_M, DISTANCE_HEIGHTS * subject.height_m) * Math.max(1, 0.8 / aspect);
  const preferred = Math.atan2(sun.z, sun.x) + BESIDE_SUN_RAD;
  let best = { x: subject.x, z: subject.z };
  let least = Number.POSITIVE_INFINITY;
  for (let k = 0; k < DIRECTION_COUNT; k++) {
    const turn = (2 * Math.PI * k) / DIRECTION_COUNT;
    const eye = {
      x: subject.x + away_m * Math.cos(preferred + turn),
      z: subject.z + away_m * Math.sin(preferred + turn),
    };
    const cost = HIDDEN_COST * hidden(subject, eye, others) + 0.5 * (1 - Math.cos(turn));
    if (cost >= least) continue;
    least = cost;
    best = eye;
  }
  const { x, z } = subject;
  return {
    eye: { ...best, y: groundHeight_m(best.x, best.z) + 0.28 * subject.height_m + 1.2 },
    target: { x, y: groundHeight_m(x, z) + 0.52 * subject.height_m, z },
  };
}
