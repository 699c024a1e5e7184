/** Viewpoints, and the path of the fly-through. Pure. */
import { gladeCentre_m, groundHeight_m } from "../ground/landscape";

interface Point {
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

export interface Viewpoint {
  readonly eye: Point;
  readonly target: Point;
}

/** A tree that a view may show. */
export interface Subject {
  readonly x: number;
  readonly z: number;
  readonly height_m: number;
}

export const VIEWS = {
  edge: "Forest edge",
  canopy: "Above the canopy",
  under: "Below the canopy",
  tree: "Single tree",
} as const;
export type ViewName = keyof typeof VIEWS;

const above = (x: number, height_m: number, z: number): Point => ({
  x,
  y: groundHeight_m(x, z) + height_m,
  z,
});

/** Height of a visitor's eyes, m. */
const EYE_HEIGHT_M = 1.7;

/** Where the page opens: in the glade at the edge of the forest, 15 m from the first crowns, as a visitor sees them. */
export const EDGE_VIEW: Viewpoint = { eye: above(1, EYE_HEIGHT_M, 9.5), target: above(7.5, 4.6, -8) };

/** A place in the glade that shows the trees on one side from below. */
function underCrowns(): Viewpoint {
  const z = -19;
  const x = gladeCentre_m(z) + 3;
  return { eye: above(x, EYE_HEIGHT_M, z), target: above(x + 11, 6.4, z - 8) };
}

/** From the sunny side, at a distance at which the tree fills the view. */
function oneTree(subject: Subject, sun: { x: number; z: number }): Viewpoint {
  const away_m = 1.55 * subject.height_m;
  const side = Math.atan2(sun.z, sun.x) + 0.7;
  const x = subject.x + away_m * Math.cos(side);
  const z = subject.z + away_m * Math.sin(side);
  return {
    eye: above(x, 0.28 * subject.height_m + 1.2, z),
    target: above(subject.x, 0.52 * subject.height_m, subject.z),
  };
}

/** The most isolated tree near the centre; null without trees. */
export function loneliest(trees: readonly Subject[]): Subject | null {
  let best: Subject | null = null;
  let most = -1;
  for (const tree of trees) {
    if (Math.hypot(tree.x, tree.z) > 70) continue;
    let room = Number.POSITIVE_INFINITY;
    for (const other of trees) {
      if (other !== tree) room = Math.min(room, Math.hypot(tree.x - other.x, tree.z - other.z));
    }
    // Prefer tall trees, even with a closer neighbour.
    const worth = Math.min(room, 60) * Math.sqrt(tree.height_m);
    if (worth <= most) continue;
    most = worth;
    best = tree;
  }
  return best;
}

export function viewpoint(
  name: ViewName,
  trees: readonly Subject[],
  sun: { x: number; z: number },
): Viewpoint {
  if (name === "canopy") return { eye: above(22, 27, 30), target: above(-8, 4, -34) };
  if (name === "under") return underCrowns();
  const subject = name === "tree" ? loneliest(trees) : null;
  return subject ? oneTree(subject, sun) : EDGE_VIEW;
}

/** Duration of one round, s. */
export const FLIGHT_S = 84;

/** Waypoints: up the glade near the ground, over the crowns, and back. */
const STATIONS: readonly (readonly [across: number, above: number, z: number])[] = [
  [5, 7.5, 26],
  [1, 3.2, 4],
  [0, 2.6, -18],
  [1, 5, -40],
  [14, 19, -58],
  [34, 24, -38],
  [40, 22, -6],
  [26, 13, 22],
];

const spline = (a: number, b: number, c: number, d: number, t: number) =>
  0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t * t * t);

function along(share: number): Point {
  const at = (share - Math.floor(share)) * STATIONS.length;
  const k = Math.floor(at);
  const station = (i: number) => STATIONS[(i + STATIONS.length) % STATIONS.length];
  const value = (of: (s: (typeof STATIONS)[number]) => number) =>
    spline(of(station(k - 1)), of(station(k)), of(station(k + 1)), of(station(k + 2)), at - k);
  const z = value((s) => s[2]);
  return above(
    value((s) => gladeCentre_m(s[2]) + s[0]),
    Math.max(
      2,
      value((s) => s[1]),
    ),
    z,
  );
}

/** Position and target after a time (s): looking ahead, and slightly down when high. */
export function flightAt(time_s: number): Viewpoint {
  const share = time_s / FLIGHT_S;
  const eye = along(share);
  const ahead = along(share + 0.07);
  const height_m = eye.y - groundHeight_m(eye.x, eye.z);
  return { eye, target: { x: ahead.x, y: ahead.y - 0.22 * height_m + 0.6, z: ahead.z } };
}
