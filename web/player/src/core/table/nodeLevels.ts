/** Fewer nodes and modes for distant trees: nodes that move alike are merged. Pure. */
import { TURN_ARM } from "../constants";
import { BEND_NODE_COUNT } from "./cardLevel";
import type { NodeLevel } from "./drawnTable";
import { leadingCoordinates } from "./leadingCoordinates";
import type { Table } from "./table";

/** Number of nodes without those for impostors, and of texels of four modes (the last holds the wind), for each level after the full one. */
const COARSER_LEVELS = [
  { nodes: 256, quads: 6 },
  { nodes: 112, quads: 4 },
  { nodes: 48, quads: 2 },
  { nodes: 24, quads: 2 },
] as const;

/** Rows of displacement and rotation, [nodes, 6, modes], in proportion to distances in space. */
function weighed({ nodeBasis, nodeTurn, modeScale, metadata }: Table): Float32Array {
  const { modes, height_m } = metadata;
  const width = 3 * modes;
  const rows = new Float32Array(2 * nodeBasis.length);
  nodeBasis.forEach((value, i) => {
    const at = 2 * width * Math.floor(i / width) + (i % width);
    const scale = modeScale[i % modes];
    rows[at] = value * scale;
    rows[at + width] = nodeTurn[i] * TURN_ARM * height_m * scale;
  });
  return rows;
}

/** Squared distance of two rows, or a part of it that is `most` or more. */
function squaredDistance(rows: Float32Array, width: number, a: number, b: number, most: number): number {
  let sum = 0;
  for (let k = 0; k < width && sum < most; k++) {
    const apart = rows[a * width + k] - rows[b * width + k];
    sum += apart * apart;
  }
  return sum;
}

/**
 * Farthest-point clustering of rows (Gonzalez 1985; error at most twice the optimum): each new group starts at the row
 * farthest from all previous centres. Returns the group of each row for each of the given numbers of groups.
 */
export function groupRows(rows: Float32Array, width: number, numbers: readonly number[]): Uint16Array[] {
  const count = rows.length / width;
  const group = new Uint16Array(count);
  const distance = new Float32Array(count).fill(Number.POSITIVE_INFINITY);
  const taken = new Map<number, Uint16Array>();
  let centre = 0;
  for (let g = 0; g < Math.max(...numbers); g++) {
    for (let row = 0; row < count; row++) {
      const d = squaredDistance(rows, width, row, centre, distance[row]);
      if (d >= distance[row]) continue;
      distance[row] = d;
      group[row] = g;
    }
    taken.set(g + 1, group.slice());
    centre = distance.indexOf(Math.max(...distance));
    if (distance[centre] === 0) break;
  }
  const most = taken.size;
  return numbers.map((number) => taken.get(Math.min(number, most)) ?? group);
}

/** Share of each node in its group, by its render vertices. */
function sharesOf({ vertexNode }: Table, group: Uint16Array, groups: number): Float64Array {
  const weight = new Float64Array(groups);
  const vertices = new Float64Array(group.length).fill(1e-6); // nodes without vertices have negligible weight
  for (const node of vertexNode) vertices[node]++;
  for (let node = 0; node < group.length; node++) weight[group[node]] += vertices[node];
  return vertices.map((count, node) => count / weight[group[node]]);
}

/** A node of a table, the node of a level in which it is merged with others, and its share in that. */
interface Member {
  readonly node: number;
  readonly group: number;
  readonly share: number;
}

/** Means of rows [nodes, 3, modes] in each group, [groups, 3, stride], of these modes; the rest is zero. */
function meanRows(
  rows: Float32Array,
  modes: number,
  members: readonly Member[],
  kept: Uint16Array,
  stride: number,
): Float32Array<ArrayBuffer> {
  const groups = members.reduce((most, { group }) => Math.max(most, group + 1), 0);
  const mean = new Float32Array(groups * 3 * stride);
  for (const { node, group, share } of members) {
    for (let axis = 0; axis < 3; axis++) {
      const from = (node * 3 + axis) * modes;
      const to = (group * 3 + axis) * stride;
      for (let k = 0; k < kept.length; k++) mean[to + k] += share * rows[from + kept[k]];
    }
  }
  return mean;
}

/** The group before each: that of the node before its first node. */
function groupParents(parent: Uint16Array, group: Uint16Array, groups: number): number[] {
  const first = new Int32Array(groups).fill(-1);
  group.forEach((g, node) => {
    if (first[g] < 0) first[g] = node;
  });
  return Array.from(first, (node, g) => (node < 0 ? g : group[parent[node]]));
}

/** The levels of meshes after the full one. */
export function coarserNodes(table: Table, bend: NodeLevel["bend"]): NodeLevel[] {
  const { modes: all } = table.metadata;
  const numbers = COARSER_LEVELS.map(({ nodes }) => nodes);
  const grouped = groupRows(weighed(table), 6 * all, numbers);
  return COARSER_LEVELS.map(({ quads: most }, level) => {
    const of = grouped[level].slice();
    const merged = of.reduce((a, b) => Math.max(a, b), 0) + 1;
    const quads = Math.min(most, Math.ceil((all + 1) / 4));
    const coordinates = leadingCoordinates(all, table.modal.step.length / 6, 4 * quads - 1);
    const shares = sharesOf(table, of, merged);
    const members = [
      ...Array.from(of, (group, node) => ({ node, group, share: shares[node] })),
      ...bend.map((node, k) => ({ node, group: merged + k, share: 1 })),
    ];
    const mean = (rows: Float32Array) => meanRows(rows, all, members, coordinates, 4 * quads);
    return {
      nodes: merged + BEND_NODE_COUNT,
      quads,
      coordinates,
      of,
      basis: mean(table.nodeBasis),
      turn: mean(table.nodeTurn),
      rest_m: meanRows(table.nodeRest, 1, members, Uint16Array.of(0), 1),
      parent: Uint16Array.from([...groupParents(table.nodeParent, of, merged), merged, merged + 1]),
      bend: [merged, merged + 1],
    };
  });
}
