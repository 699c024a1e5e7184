/** Connected pieces of an indexed mesh: single leaves, single branches. Pure. */

export interface Components {
  /** Piece of each vertex. */
  readonly ofVertex: Uint32Array;
  readonly count: number;
}

function find(parent: Uint32Array, vertex: number): number {
  let root = vertex;
  while (parent[root] !== root) root = parent[root];
  while (parent[vertex] !== root) {
    const next = parent[vertex];
    parent[vertex] = root;
    vertex = next;
  }
  return root;
}

/** Each vertex as a piece of its own. Loops here and below: `from` with a function takes ten times as long. */
export function separate(vertices: number): Uint32Array {
  const parent = new Uint32Array(vertices);
  for (let v = 0; v < vertices; v++) parent[v] = v;
  return parent;
}

/** Joins the pieces of two vertices. */
function join(parent: Uint32Array, root: number, other: number): void {
  parent[find(parent, other)] = root;
}

/** Pieces numbered by their first vertex. */
function numbered(parent: Uint32Array): Components {
  const vertices = parent.length;
  const ofVertex = new Uint32Array(vertices);
  const number = new Int32Array(vertices).fill(-1);
  let count = 0;
  for (let v = 0; v < vertices; v++) {
    const root = find(parent, v);
    if (number[root] < 0) number[root] = count++;
    ofVertex[v] = number[root];
  }
  return { ofVertex, count };
}

function joinTriangles(parent: Uint32Array, index: ArrayLike<number>): void {
  for (let i = 0; i < index.length; i += 3) {
    const root = find(parent, index[i]);
    join(parent, root, index[i + 1]);
    join(parent, root, index[i + 2]);
  }
}

/** Connected components: vertices that share a triangle. Pieces are numbered by their first vertex. */
export function connectedComponents(index: ArrayLike<number>, vertices: number): Components {
  const parent = separate(vertices);
  joinTriangles(parent, index);
  return numbered(parent);
}

/** Joins each vertex with the first one at the same place, by a hash table with linear probing. */
function joinCoincident(parent: Uint32Array, positions: ArrayLike<number>): void {
  const vertices = parent.length;
  const slots = 2 ** Math.ceil(Math.log2(2 * vertices + 1));
  const taken = new Int32Array(slots).fill(-1);
  const places = new Float32Array(positions.length);
  for (let i = 0; i < places.length; i++) places[i] = positions[i] + 0; // + 0: −0 equals 0
  const bits = new Int32Array(places.buffer);
  for (let v = 0; v < vertices; v++) {
    const a = bits[3 * v];
    const b = bits[3 * v + 1];
    const c = bits[3 * v + 2];
    let hash = Math.imul(a, 73856093) ^ Math.imul(b, 19349663) ^ Math.imul(c, 83492791);
    hash = Math.imul(hash ^ (hash >>> 15), 0x2c1b3c6d);
    let slot = (hash ^ (hash >>> 13)) & (slots - 1);
    for (; taken[slot] >= 0; slot = (slot + 1) & (slots - 1)) {
      const w = 3 * taken[slot];
      if (bits[w] === a && bits[w + 1] === b && bits[w + 2] === c) break;
    }
    if (taken[slot] < 0) taken[slot] = v;
    parent[v] = taken[slot];
  }
}

/** Same after merging coincident vertices, so that texture or normal seams do not split a branch. */
export function weldedComponents(index: ArrayLike<number>, positions: ArrayLike<number>): Components {
  const parent = separate(positions.length / 3);
  joinCoincident(parent, positions);
  joinTriangles(parent, index);
  return numbered(parent);
}

/** Mean position of each piece, xyz packed. */
export function componentCentres(components: Components, positions: ArrayLike<number>): Float32Array {
  const centres = new Float32Array(components.count * 3);
  const sizes = new Uint32Array(components.count);
  components.ofVertex.forEach((piece, v) => {
    sizes[piece]++;
    for (let axis = 0; axis < 3; axis++) centres[piece * 3 + axis] += positions[v * 3 + axis];
  });
  for (let i = 0; i < centres.length; i++) centres[i] /= sizes[Math.floor(i / 3)];
  return centres;
}

/** Where each leaf is attached: its first vertex, xyz packed. */
export function petioles(components: Components, positions: ArrayLike<number>): Float32Array {
  const bases = new Float32Array(components.count * 3);
  const known = new Uint8Array(components.count);
  components.ofVertex.forEach((piece, v) => {
    if (known[piece]) return;
    known[piece] = 1;
    for (let axis = 0; axis < 3; axis++) bases[piece * 3 + axis] = positions[v * 3 + axis];
  });
  return bases;
}

/** Largest distance of a vertex of each piece from the piece's centre. */
export function componentRadii(
  components: Components,
  positions: ArrayLike<number>,
  centres: Float32Array,
): Float32Array {
  const radii = new Float32Array(components.count);
  components.ofVertex.forEach((piece, v) => {
    const distance = Math.hypot(
      positions[v * 3] - centres[piece * 3],
      positions[v * 3 + 1] - centres[piece * 3 + 1],
      positions[v * 3 + 2] - centres[piece * 3 + 2],
    );
    radii[piece] = Math.max(radii[piece], distance);
  });
  return radii;
}

/** A piece with more vertices is too large to be bound to a single node. */
const MOST_OF_LEAF = 16;

/** Maps the vertices of a small piece to its first vertex; those of a large piece to themselves. */
export function holders({ ofVertex, count }: Components): Uint32Array {
  const first = new Int32Array(count).fill(-1);
  const sizes = new Uint32Array(count);
  ofVertex.forEach((piece, v) => {
    if (first[piece] < 0) first[piece] = v;
    sizes[piece]++;
  });
  return ofVertex.map((piece, v) => (sizes[piece] > MOST_OF_LEAF ? v : first[piece]));
}
