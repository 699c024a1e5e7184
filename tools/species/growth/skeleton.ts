import type { Vector3 } from "three";
import { BREAST_HEIGHT_M } from "../../../web/player/src/core/constants";

/** One section of a branch. Parents precede their children. */
export interface SkeletonNode {
  position: Vector3;
  /** Index of the node below, -1 for the root. */
  parent: number;
  /** Branch id; a branch includes its leaders. */
  branch: number;
  /** 0 trunk, 1 bough, 2 limb. */
  level: number;
  radius: number;
}

/**
 * Thickness of the wood. The stem follows Ormerod's taper: radius proportional to (height above)^taper. The cross-section
 * of boughs and limbs depends on the length of wood carried (pipe model).
 */
export interface Girth {
  /** Radius of the stem at 1.3 m, m. */
  breast_radius_m: number;
  /** Exponent of the stem's taper: 1 is a cone, lower values are fuller. */
  taper: number;
  /** Radius of the base of the bough that carries most, m. */
  bough_radius_m: number;
  tip_radius_m: number;
  /** 0.5 conserves the cross-section at forks (Leonardo's rule); lower values make limbs thicker. */
  exponent: number;
  /** Relative swelling of the stem base, and the height (m) over which it decays. */
  flare: number;
  flare_height_m: number;
}

/** Radius of the stem's tip over that of a limb's. */
const STEM_TIP = 1.8;
/** No branch is thicker at its base than this share of its parent's radius. */
const MOST_OF_PARENT = 0.65;

/** Scales and moves the tree in place: base at the origin, top of the wood at `height_m`. */
export function scaleToHeight(nodes: SkeletonNode[], height_m: number): void {
  const foot = nodes[0].position.clone();
  const top = nodes.reduce((best, node) => Math.max(best, node.position.y - foot.y), 0);
  for (const node of nodes) node.position.sub(foot).multiplyScalar(height_m / top);
}

/** Length of wood carried by each node, m. */
function carriedLength(nodes: readonly SkeletonNode[]): Float64Array {
  const carried = new Float64Array(nodes.length);
  for (let i = nodes.length - 1; i > 0; i--) {
    const { parent, position } = nodes[i];
    carried[parent] += carried[i] + position.distanceTo(nodes[parent].position);
  }
  return carried;
}

/** Sets every radius. */
export function setGirth(nodes: SkeletonNode[], girth: Girth): void {
  const { breast_radius_m, taper, tip_radius_m } = girth;
  const top_m = nodes.reduce((top, node) => (node.level === 0 ? Math.max(top, node.position.y) : top), 0);
  for (const node of nodes) {
    if (node.level > 0) continue;
    const share = (top_m - node.position.y) / (top_m - BREAST_HEIGHT_M);
    const swelling = girth.flare * Math.exp(-node.position.y / girth.flare_height_m);
    const end_m = STEM_TIP * tip_radius_m;
    node.radius = (end_m + (breast_radius_m - end_m) * share ** taper) * (1 + swelling);
  }
  setLimbs(nodes, girth);
}

function setLimbs(nodes: SkeletonNode[], { bough_radius_m, tip_radius_m, exponent }: Girth): void {
  const carried = carriedLength(nodes);
  const most = nodes.reduce((best, { level }, i) => (level > 0 ? Math.max(best, carried[i]) : best), 0);
  const thinner = new Map<number, number>();
  nodes.forEach((node, i) => {
    if (node.level === 0) return;
    const full = tip_radius_m + (bough_radius_m - tip_radius_m) * (carried[i] / most) ** exponent;
    const bearer = nodes[node.parent];
    if (bearer.branch !== node.branch)
      thinner.set(node.branch, Math.min(1, (MOST_OF_PARENT * bearer.radius) / full));
    node.radius = Math.max(full * (thinner.get(node.branch) ?? 1), Math.min(tip_radius_m, bearer.radius));
  });
}

/** Node indices of each branch from its fork to its tip. */
export function branches(nodes: readonly SkeletonNode[]): number[][] {
  const lists: number[][] = [];
  nodes.forEach((node, i) => {
    if (!lists[node.branch]) lists[node.branch] = [];
    lists[node.branch].push(i);
  });
  return lists;
}

/** The skeleton as a small JSON document (columns; metres to the tenth of a millimetre). */
export function skeletonJson(name: string, nodes: readonly SkeletonNode[]): string {
  const round = (x: number): number => Math.round(x * 1e4) / 1e4;
  const columns = {
    name,
    units: "m",
    points_m: nodes.map(({ position: p }) => [round(p.x), round(p.y), round(p.z)]),
    radius_m: nodes.map((node) => round(node.radius)),
    parent: nodes.map((node) => node.parent),
    branch: nodes.map((node) => node.branch),
    level: nodes.map((node) => node.level),
  };
  return `${JSON.stringify(columns)}\n`;
}
