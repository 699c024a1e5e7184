/**
 * Adaptation of the exposure to what the camera sees, like an eye: brighter below the crowns than in the open. Estimated
 * from rays against the crowns near the camera instead of from the picture, whose read-back would stall the GPU. Pure.
 */

import { smoothstep } from "./weather";

export interface Vector {
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

/**
 * Crowns as upright ellipsoids, packed: centre (x, y, z), half width, half height, m; colour of the leaves; 1 if these
 * fall, 0 of evergreens. */
export type Crowns = Float32Array;
export const CROWN_FLOATS = 9;

/** Rays of the view, across × up. */
const RAYS = { across: 5, up: 3 } as const;
/** Crowns farther away cover little of the view each. */
export const NEAR_M = 45;
/** Light of a surface in shade relative to one in the sun. */
const SHADE_LIGHT_RATIO = 0.2;
/** Light behind several crowns does not get darker than this. */
const MIN_LIGHT_RATIO = 0.12;
/** Light of leaves around an eye inside a crown, which shade each other; beside it, leaves nearer than this (m) fill the view like them. */
const INSIDE_LIGHT_RATIO = 0.05;
const CLOSE_LEAVES_M = 3;
/** Largest gain, inside dense crowns. */
export const MOST_GAIN = 2.4;
/** Share of the adaptation of an eye that is wanted: the shade of a forest stays darker than a meadow. */
const ADAPTATION_SHARE = 0.52;
/** Light of an ordinary view, part of it in shade, for which the exposure of the season and the hour is right. */
const USUAL_LIGHT = 0.6;
/** Height (m) from which on an eye looks over the crowns, at mostly sky and sunlit land. */
const OVERLOOK_M = [14, 30] as const;
/** Part of the adaptation with a low sun, whose sine is below the first number; all of it from the second one on. */
const LOW_SUN_ADAPTATION = 0.3;
const LOW_SUN_SINE = [0.08, 0.45] as const;
const EASE_S = 0.5;
const SETTLED_CHANGE = 0.004;

/** Distance along a ray to an ellipsoid; infinite if it misses. The eye inside counts as 0. */
export function crownDistance(from: Vector, to: Vector, crowns: Crowns, crown: number): number {
  const at = crown * CROWN_FLOATS;
  const [wide, tall] = [crowns[at + 3], crowns[at + 4]];
  const [ox, oy, oz] = [
    (from.x - crowns[at]) / wide,
    (from.y - crowns[at + 1]) / tall,
    (from.z - crowns[at + 2]) / wide,
  ];
  const [dx, dy, dz] = [to.x / wide, to.y / tall, to.z / wide];
  const a = dx * dx + dy * dy + dz * dz;
  const b = ox * dx + oy * dy + oz * dz;
  const c = ox * ox + oy * oy + oz * oz - 1;
  const root = b * b - a * c;
  if (root < 0 || (c > 0 && b > 0)) return Number.POSITIVE_INFINITY;
  return Math.max(0, (-b - Math.sqrt(root)) / a);
}

/** The crowns within NEAR_M of a place. */
export function crownsNear(crowns: Crowns, { x, z }: { x: number; z: number }): Crowns {
  const near: number[] = [];
  for (let at = 0; at < crowns.length; at += CROWN_FLOATS) {
    if (Math.hypot(crowns[at] - x, crowns[at + 2] - z) > NEAR_M + crowns[at + 3]) continue;
    for (let k = 0; k < CROWN_FLOATS; k++) near.push(crowns[at + k]);
  }
  return Float32Array.from(near);
}

/** Light that reaches a point from the sun: 1 in the open, SHADE_LIGHT_RATIO below a dense crown. */
function sunAt(place: Vector, sun: Vector, crowns: Crowns, density: number): number {
  for (let crown = 0; crown < crowns.length / CROWN_FLOATS; crown++) {
    if (crownDistance(place, sun, crowns, crown) < Number.POSITIVE_INFINITY)
      return 1 - density * (1 - SHADE_LIGHT_RATIO);
  }
  return 1;
}

const along = (from: Vector, to: Vector, s: number): Vector => ({
  x: from.x + s * to.x,
  y: from.y + s * to.y,
  z: from.z + s * to.z,
});

/** Light seen along one ray, 1 for sunlit land and sky. */
function lightAlong(eye: Vector, ray: Vector, scene: Surroundings): number {
  const { crowns, sun, ground_m, density } = scene;
  let nearest_m = Number.POSITIVE_INFINITY;
  for (let crown = 0; crown < crowns.length / CROWN_FLOATS; crown++) {
    nearest_m = Math.min(nearest_m, crownDistance(eye, ray, crowns, crown));
  }
  const down_m = ray.y < -1e-3 ? (ground_m - eye.y) / ray.y : Number.POSITIVE_INFINITY;
  if (down_m < nearest_m && down_m < 2 * NEAR_M) return sunAt(along(eye, ray, down_m), sun, crowns, density);
  if (nearest_m === Number.POSITIVE_INFINITY) return 1;
  // The near side of a crown is in its own shade unless the sun is behind the eye.
  const place = along(eye, ray, Math.max(0, nearest_m - 0.2));
  const own = 0.5 + 0.5 * Math.max(-1, Math.min(1, -(ray.x * sun.x + ray.y * sun.y + ray.z * sun.z)));
  const lit = sunAt(place, sun, crowns, density) * (SHADE_LIGHT_RATIO + (1 - SHADE_LIGHT_RATIO) * own);
  const beside = Math.min(1, nearest_m / CLOSE_LEAVES_M);
  const light = INSIDE_LIGHT_RATIO + beside * (Math.max(MIN_LIGHT_RATIO, lit) - INSIDE_LIGHT_RATIO);
  return 1 - density * (1 - light);
}

export interface Surroundings {
  readonly crowns: Crowns;
  /** Direction towards the sun. */
  readonly sun: Vector;
  /** Height of the ground below the eye, m. */
  readonly ground_m: number;
  /** Light that a crown holds back, 0 to 1; small without leaves. */
  readonly density: number;
}

/** The camera's axes and the tangents of half its field of view. */
export interface Gaze {
  readonly eye: Vector;
  readonly forward: Vector;
  readonly right: Vector;
  readonly up: Vector;
  readonly halfWidth: number;
  readonly halfHeight: number;
}

/** Mean light of the view (geometric mean, as the eye sees ratios), relative to a sunlit open view. */
export function viewLight(gaze: Gaze, scene: Surroundings): number {
  let sum = 0;
  for (let row = 0; row < RAYS.up; row++) {
    for (let column = 0; column < RAYS.across; column++) {
      const u = ((2 * (column + 0.5)) / RAYS.across - 1) * gaze.halfWidth;
      const v = ((2 * (row + 0.5)) / RAYS.up - 1) * gaze.halfHeight;
      const ray = {
        x: gaze.forward.x + u * gaze.right.x + v * gaze.up.x,
        y: gaze.forward.y + u * gaze.right.y + v * gaze.up.y,
        z: gaze.forward.z + u * gaze.right.z + v * gaze.up.z,
      };
      const length = Math.hypot(ray.x, ray.y, ray.z);
      const unit = { x: ray.x / length, y: ray.y / length, z: ray.z / length };
      sum += Math.log(lightAlong(gaze.eye, unit, scene));
    }
  }
  return Math.exp(sum / (RAYS.up * RAYS.across));
}

/**
 * Gain of the exposure for a view of this light, at most MOST_GAIN. Nearer to 1 for a low sun, whose long shadows the
 * exposure of the hour already allows for. `sunSine`: sine of the sun's elevation; 1 below closed clouds, where there are no shadows. `above_m`: height of the eye above the ground.
 */
export function gainFor(light: number, sunSine = 1, above_m = 0): number {
  const gain = (Math.max(1e-6, light) / USUAL_LIGHT) ** -ADAPTATION_SHARE;
  const adapted = gain > 1 ? gain - 1 : (gain - 1) * smoothstep(OVERLOOK_M[0], OVERLOOK_M[1], above_m);
  const wanted =
    1 + adapted * (LOW_SUN_ADAPTATION + (1 - LOW_SUN_ADAPTATION) * smoothstep(...LOW_SUN_SINE, sunSine));
  return Math.min(MOST_GAIN, wanted);
}

/** One step of the gain towards its target; reaches it exactly. */
export function easeGain(gain: number, target: number, dt_s: number): number {
  const next = gain + (1 - Math.exp(-Math.max(0, dt_s) / EASE_S)) * (target - gain);
  return Math.abs(target - next) < SETTLED_CHANGE ? target : next;
}
