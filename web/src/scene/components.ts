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

/** Vertices that share a triangle belong together. Pieces are numbered by their first vertex. */
export function connectedComponents(index: ArrayLike<number>, vertices: number): Components {
  const parent = Uint32Array.from({ length: vertices }, (_, v) => v);
  for (let i = 0; i < index.length; i += 3) {
    const a = find(parent, index[i]);
    for (const other of [index[i + 1], index[i + 2]]) parent[find(parent, other)] = a;
  }
  const number = new Map<number, number>();
  const ofVertex = new Uint32Array(vertices);
  for (let v = 0; v < vertices; v++) {
    const root = find(parent, v);
    const piece = number.get(root) ?? number.size;
    number.set(root, piece);
    ofVertex[v] = piece;
  }
  return { ofVertex, count: number.size };
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
