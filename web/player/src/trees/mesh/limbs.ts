/**
 * Finds the limb of each branch, twig and leaf, so that the trees of a species can differ by the limbs that they
 * lack. Only positions are known: a side branch begins inside its parent, a twig on its limb, a leaf on its twig. Pure.
 */
import type { Components } from "./components";

/** A part of the mesh in the order of support: wood, then twigs, then leaves. */
export interface PartGeometry {
  readonly kind: "wood" | "twigs" | "leaves";
  readonly positions: ArrayLike<number>;
  readonly index: ArrayLike<number>;
  readonly pieces: Components;
}

/** Number of a limb per piece; this one means the stem and what grows on it. */
export const STEM_LIMB = -1;
/** Long edges are sampled at this distance, m, and the samples are found in cells of this size. */
const STEP_M = 0.3;
/** Farther than this from anything, a piece counts as attached to the stem. */
const FARTHEST_CELLS = 6;

/** Points in space with a number each, found by their distance. */
class Nearby {
  private readonly cells = new Map<number, number[]>();
  private readonly points: number[] = [];
  private readonly numbers: number[] = [];

  private static key(i: number, j: number, k: number): number {
    return ((i + 2048) * 4096 + (j + 2048)) * 4096 + (k + 2048);
  }

  add(x: number, y: number, z: number, number: number): void {
    const key = Nearby.key(Math.floor(x / STEP_M), Math.floor(y / STEP_M), Math.floor(z / STEP_M));
    const cell = this.cells.get(key);
    if (cell) cell.push(this.numbers.length);
    else this.cells.set(key, [this.numbers.length]);
    this.points.push(x, y, z);
    this.numbers.push(number);
  }

  /** The number of the nearest point; null if all are far. */
  find(x: number, y: number, z: number): number | null {
    const [i, j, k] = [Math.floor(x / STEP_M), Math.floor(y / STEP_M), Math.floor(z / STEP_M)];
    let best: number | null = null;
    let least = Number.POSITIVE_INFINITY;
    for (let reach = 0; reach <= FARTHEST_CELLS; reach++) {
      // All points outside the cells searched so far are at least this far away.
      if (least <= (reach - 1) * STEP_M) break;
      for (let a = i - reach; a <= i + reach; a++) {
        for (let b = j - reach; b <= j + reach; b++) {
          const side = Math.abs(a - i) === reach || Math.abs(b - j) === reach;
          for (let c = k - reach; c <= k + reach; c += side ? 1 : Math.max(1, 2 * reach)) {
            for (const at of this.cells.get(Nearby.key(a, b, c)) ?? []) {
              const dx = this.points[3 * at] - x;
              const dy = this.points[3 * at + 1] - y;
              const dz = this.points[3 * at + 2] - z;
              const distance = Math.sqrt(dx * dx + dy * dy + dz * dz);
              if (distance >= least) continue;
              least = distance;
              best = this.numbers[at];
            }
          }
        }
      }
    }
    return best;
  }
}

/** The numbers 0, 1, …, n − 1 in groups: those of group g are at `members` from `start[g]` to `start[g + 1]`. */
interface Grouped {
  readonly start: Uint32Array;
  readonly members: Uint32Array;
}

function grouped(n: number, groups: number, groupOf: (member: number) => number): Grouped {
  const start = new Uint32Array(groups + 1);
  for (let member = 0; member < n; member++) start[groupOf(member) + 1]++;
  for (let g = 0; g < groups; g++) start[g + 1] += start[g];
  const next = start.slice();
  const members = new Uint32Array(n);
  for (let member = 0; member < n; member++) members[next[groupOf(member)]++] = member;
  return { start, members };
}

/** Points on the vertices and long edges of single pieces of a part. */
class Samples {
  private readonly vertices: Grouped;
  private readonly corners: Grouped;

  constructor(private readonly part: PartGeometry) {
    const { ofVertex, count } = part.pieces;
    this.vertices = grouped(ofVertex.length, count, (v) => ofVertex[v]);
    this.corners = grouped(part.index.length, count, (i) => ofVertex[part.index[i]]);
  }

  /** Adds the points of a piece, all with the same number. */
  add(piece: number, into: Nearby, number: number): void {
    const { positions } = this.part;
    const { vertices, corners } = this;
    for (let i = vertices.start[piece]; i < vertices.start[piece + 1]; i++) {
      const v = 3 * vertices.members[i];
      into.add(positions[v], positions[v + 1], positions[v + 2], number);
    }
    for (let i = corners.start[piece]; i < corners.start[piece + 1]; i++) {
      this.addEdge(corners.members[i], into, number);
    }
  }

  /** Adds points between the ends of the edge that begins at a corner of a triangle. */
  private addEdge(corner: number, into: Nearby, number: number): void {
    const { positions, index } = this.part;
    const from = index[corner];
    const to = index[corner % 3 === 2 ? corner - 2 : corner + 1];
    if (from > to) return; // the other triangle of the edge has it in the other direction
    const [x, y, z] = [positions[3 * from], positions[3 * from + 1], positions[3 * from + 2]];
    const dx = positions[3 * to] - x;
    const dy = positions[3 * to + 1] - y;
    const dz = positions[3 * to + 2] - z;
    const steps = Math.ceil(Math.sqrt(dx * dx + dy * dy + dz * dz) / STEP_M);
    for (let s = 1; s < steps; s++) {
      const t = s / steps;
      into.add(x + t * dx, y + t * dy, z + t * dz, number);
    }
  }

  /** Adds the points of all pieces. */
  addAll(into: Nearby, numbers: Int32Array): void {
    numbers.forEach((number, piece) => {
      this.add(piece, into, number);
    });
  }
}

/** First vertex of every piece: the base of a branch, twig or leaf is written first. */
function firstVertices({ ofVertex, count }: Components): Uint32Array {
  const first = new Uint32Array(count).fill(ofVertex.length);
  ofVertex.forEach((piece, v) => {
    if (v < first[piece]) first[piece] = v;
  });
  return first;
}

/** Middle of the first vertices: the first ring of a twig, the lower edge of a leaf card, a place on a branch's ring. */
function baseOf(part: PartGeometry, first: number, piece: number): [number, number, number] {
  const { positions, pieces } = part;
  const last = Math.min(pieces.ofVertex.length, first + (part.kind === "leaves" ? 2 : 3));
  const sum = [0, 0, 0];
  let count = 0;
  for (let v = first; v < last && pieces.ofVertex[v] === piece; v++, count++) {
    for (let axis = 0; axis < 3; axis++) sum[axis] += positions[3 * v + axis];
  }
  return [sum[0] / count, sum[1] / count, sum[2] / count];
}

/** Height of each piece of the wood: the stem is the tallest. */
function stemOf({ positions, pieces }: PartGeometry): number {
  const low = new Float32Array(pieces.count).fill(Number.POSITIVE_INFINITY);
  const high = new Float32Array(pieces.count).fill(Number.NEGATIVE_INFINITY);
  pieces.ofVertex.forEach((piece, v) => {
    low[piece] = Math.min(low[piece], positions[3 * v + 1]);
    high[piece] = Math.max(high[piece], positions[3 * v + 1]);
  });
  let stem = 0;
  for (let piece = 1; piece < pieces.count; piece++) {
    if (high[piece] - low[piece] > high[stem] - low[stem]) stem = piece;
  }
  return stem;
}

/** The limb of every piece of the wood; branches come after their parents. */
function limbsOfWood(wood: PartGeometry): Int32Array {
  const stem = stemOf(wood);
  const first = firstVertices(wood.pieces);
  const limb = new Int32Array(wood.pieces.count).fill(STEM_LIMB);
  const order = [...first.keys()].filter((piece) => piece !== stem).sort((a, b) => first[a] - first[b]);
  const known = new Nearby();
  const samples = new Samples(wood);
  samples.add(stem, known, STEM_LIMB);
  let limbs = 0;
  for (const piece of order) {
    const parent = known.find(...baseOf(wood, first[piece], piece));
    limb[piece] = parent === null || parent === STEM_LIMB ? limbs++ : parent;
    samples.add(piece, known, limb[piece]);
  }
  return limb;
}

/** The limb of every piece of each part; STEM_LIMB where it grows on the stem. Parts without wood are all STEM_LIMB. */
export function limbsOf(parts: readonly PartGeometry[]): Int32Array[] {
  const known = { wood: new Nearby(), twigs: new Nearby() };
  let twigs = false;
  return parts.map((part) => {
    if (part.kind === "wood") {
      const limb = limbsOfWood(part);
      new Samples(part).addAll(known.wood, limb);
      return limb;
    }
    const from = part.kind === "leaves" && twigs ? known.twigs : known.wood;
    const first = firstVertices(part.pieces);
    const limb = Int32Array.from(first, (v, piece) => from.find(...baseOf(part, v, piece)) ?? STEM_LIMB);
    if (part.kind === "twigs") {
      twigs = true;
      new Samples(part).addAll(known.twigs, limb);
    }
    return limb;
  });
}
