/** Fewer nodes and modes for distant trees: nodes that move alike are merged. Pure. */
import { fittedModes, type Table } from "../../core/table/table";
import type { NodeLevel } from "../protocol";

/**
 * Number of nodes, of texels of four modes (the last holds the wind), and of modes of the gust layer among them, for
 * each level after the full one.
 */
const COARSER = [
  { nodes: 256, quads: 6, gusts: 8 },
  { nodes: 112, quads: 4, gusts: 4 },
  { nodes: 48, quads: 2, gusts: 2 },
  { nodes: 24, quads: 2, gusts: 2 },
] as const;

/** Basis rows scaled by the typical amplitude of each mode, so that distances between rows are distances in space. */
function weighed(table: Table): Float32Array {
  const { nodeBasis, modeScale } = table;
  return nodeBasis.map((value, i) => value * modeScale[i % modeScale.length]);
}

function squaredDistance(rows: Float32Array, width: number, a: number, b: number): number {
  let sum = 0;
  for (let k = 0; k < width; k++) sum += (rows[a * width + k] - rows[b * width + k]) ** 2;
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
      const d = squaredDistance(rows, width, row, centre);
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

/** Mean basis of each group over its render vertices, [groups, 3, 4 quads]; wind and padding are zero. */
function groupBasis(table: Table, group: Uint16Array, groups: number, columns: Uint16Array, stride: number) {
  const { modes: all } = table.metadata;
  const basis = new Float32Array(groups * 3 * stride);
  const weight = new Float64Array(groups);
  const vertices = new Float64Array(group.length).fill(1e-6); // nodes without vertices have negligible weight
  for (const node of table.vertexNode) vertices[node]++;
  for (let node = 0; node < group.length; node++) weight[group[node]] += vertices[node];
  for (let node = 0; node < group.length; node++) {
    const share = vertices[node] / weight[group[node]];
    for (let axis = 0; axis < 3; axis++) {
      const from = (node * 3 + axis) * all;
      const to = (group[node] * 3 + axis) * stride;
      for (const [k, column] of columns.entries()) basis[to + k] += share * table.nodeBasis[from + column];
    }
  }
  return basis;
}

/** The levels after the full one. */
export function coarserNodes(table: Table): NodeLevel[] {
  const { modes: all } = table.metadata;
  const numbers = COARSER.map(({ nodes }) => nodes);
  const grouped = groupRows(weighed(table), 3 * all, numbers);
  return COARSER.map(({ quads: most, gusts }, level) => {
    const of = grouped[level].slice();
    const nodes = of.reduce((a, b) => Math.max(a, b), 0) + 1;
    const quads = Math.min(most, Math.ceil((all + 1) / 4));
    const columns = columnsOf(table, 4 * quads - 1, gusts);
    return { nodes, quads, columns, of, basis: groupBasis(table, of, nodes, columns, 4 * quads) };
  });
}

/** The modes of a level: the first fitted ones, and the first of the gust layer. Both begin with the largest. */
function columnsOf(table: Table, most: number, gusts: number): Uint16Array<ArrayBuffer> {
  const all = table.metadata.modes;
  const fitted = fittedModes(table);
  const layered = Math.min(all - fitted, Math.max(gusts, most - fitted));
  const first = Math.min(fitted, most - layered);
  return Uint16Array.from({ length: first + layered }, (_, k) => (k < first ? k : fitted + k - first));
}
