import type { Vector3 } from "three";

/** One section of a branch. Parents precede their children. */
export interface SkeletonNode {
  position: Vector3;
  /** Index of the node below, -1 for the root. */
  parent: number;
  /** Branch id; a branch includes its leaders. */
  branch: number;
  /** 0 trunk, 1 bough, 2 twig. */
  level: number;
  radius: number;
}

/** Thickness of the wood (pipe model): the cross-section depends on the length of wood carried. */
export interface Girth {
  /** Radius at breast height, m. */
  breast_radius_m: number;
  breast_height_m: number;
  tip_radius_m: number;
  /** 0.5 conserves the cross-section at forks (Leonardo's rule); lower values make twigs thicker. */
  exponent: number;
  /** Relative swelling of the stem base, and the height (m) over which it decays. */
  flare: number;
  flare_height_m: number;
}

/** Scales and moves the tree in place: base at the origin, top of the wood at `height_m`. */
export function scaleToHeight(nodes: SkeletonNode[], height_m: number): void {
  const foot = nodes[0].position.clone();
  const top = nodes.reduce((best, node) => Math.max(best, node.position.y - foot.y), 0);
  for (const node of nodes) node.position.sub(foot).multiplyScalar(height_m / top);
}

/** Length of wood carried by each node, m. */
export function carriedLength(nodes: readonly SkeletonNode[]): Float64Array {
  const carried = new Float64Array(nodes.length);
  for (let i = nodes.length - 1; i > 0; i--) {
    const { parent, position } = nodes[i];
    carried[parent] += carried[i] + position.distanceTo(nodes[parent].position);
  }
  return carried;
}

/** Sets every radius from the length carried, so that the trunk has its radius at breast height. */
export function setGirth(nodes: SkeletonNode[], girth: Girth): void {
  const carried = carriedLength(nodes);
  const reference = carried[nodeAtHeight(nodes, girth.breast_height_m)];
  const span = girth.breast_radius_m - girth.tip_radius_m;
  nodes.forEach((node, i) => {
    const share = (carried[i] / reference) ** girth.exponent;
    const swelling = node.level > 0 ? 0 : girth.flare * Math.exp(-node.position.y / girth.flare_height_m);
    node.radius = (girth.tip_radius_m + span * share) * (1 + swelling);
  });
}

function nodeAtHeight(nodes: readonly SkeletonNode[], height_m: number): number {
  let best = 0;
  nodes.forEach((node, i) => {
    const nearer = Math.abs(node.position.y - height_m) < Math.abs(nodes[best].position.y - height_m);
    if (node.level === 0 && nearer) best = i;
  });
  return best;
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
