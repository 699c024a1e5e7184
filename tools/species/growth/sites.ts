/** Places along the wood at which twigs and leaves stand. */
import type { Vector3 } from "three";
import type { Random } from "../random";
import { type Profile, sample } from "./growth";
import type { SkeletonNode } from "./skeleton";

export interface Site {
  position: Vector3;
  tangent: Vector3;
  /** Radius of the wood, m. */
  radius_m: number;
  /** Position along its branch, 0 to 1. */
  along: number;
  level: number;
  bough: number;
}

/** A straight piece of wood; `weight` is its share of the sites. */
export interface Stretch {
  from: Vector3;
  to: Vector3;
  weight: number;
  radius_m: number;
  along: number;
  level: number;
  bough: number;
}

/** The stretches of a skeleton, weighted by length and by density along trunk, boughs and limbs. */
export function stretches(nodes: readonly SkeletonNode[], density: readonly Profile[]): Stretch[] {
  const along = relativePositions(nodes);
  const bough = boughs(nodes);
  return nodes.flatMap(({ position, parent, level, radius }, i) => {
    if (parent < 0) return [];
    const from = nodes[parent].position;
    const weight = from.distanceTo(position) * Math.max(0, sample(density[level], along[i]));
    return [{ from, to: position, weight, radius_m: radius, along: along[i], level, bough: bough[i] }];
  });
}

/** Sites stratified by weight, so that no section is bare by chance. */
export function sitesOn(pieces: readonly Stretch[], count: number, random: Random): Site[] {
  const total = pieces.reduce((sum, { weight }) => sum + weight, 0);
  const sites: Site[] = [];
  let k = 0;
  let passed = 0;
  for (let i = 0; i < count; i++) {
    const target = (total * (i + random.uniform(0, 1))) / count;
    while (passed + pieces[k].weight < target && k < pieces.length - 1) passed += pieces[k++].weight;
    const { from, to, weight, radius_m, along, level, bough } = pieces[k];
    const t = weight > 0 ? (target - passed) / weight : 1;
    const tangent = to.clone().sub(from).normalize();
    sites.push({ position: from.clone().lerp(to, t), tangent, radius_m, along, level, bough });
  }
  return sites;
}

/** The tips of all branches. */
export function tips(nodes: readonly SkeletonNode[]): Site[] {
  const bough = boughs(nodes);
  const bears = new Set(nodes.filter(({ parent }) => parent >= 0).map(({ parent }) => parent));
  return nodes.flatMap(({ position, parent, level, radius }, i) => {
    if (bears.has(i) || parent < 0) return [];
    const tangent = position.clone().sub(nodes[parent].position).normalize();
    return [{ position, tangent, radius_m: radius, along: 1, level, bough: bough[i] }];
  });
}

/** Position of every node along its own branch, 0 at the fork, 1 at the tip. */
function relativePositions(nodes: readonly SkeletonNode[]): Float64Array {
  const length = new Float64Array(nodes.length);
  const total = new Map<number, number>();
  nodes.forEach(({ parent, branch, position }, i) => {
    if (parent < 0 || nodes[parent].branch !== branch) return;
    length[i] = length[parent] + position.distanceTo(nodes[parent].position);
    total.set(branch, Math.max(total.get(branch) ?? 0, length[i]));
  });
  return length.map((value, i) => value / (total.get(nodes[i].branch) || 1));
}

/** Bough of each node (the top of the trunk counts as bough 0). */
function boughs(nodes: readonly SkeletonNode[]): number[] {
  const bough: number[] = [];
  nodes.forEach((node, i) => {
    bough[i] = node.level <= 1 ? node.branch : bough[node.parent];
  });
  return bough;
}
