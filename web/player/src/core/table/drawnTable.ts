/** The parts of a table by which trees are drawn, as typed arrays that can be transferred. */

/** Nodes for one level of detail. */
export interface NodeLevel {
  readonly nodes: number;
  /** Texels per tree: the coordinates of this level, then the local wind speed in m/s, padding. */
  readonly quads: number;
  /** The coordinates of the table that this level keeps, which move it most. */
  readonly coordinates: Uint16Array<ArrayBuffer>;
  /** Node of this level for each node of the table. */
  readonly of: Uint16Array<ArrayBuffer>;
  /** [nodes, 3, 4 quads]: displacement in m per unit of each coordinate, zero beyond the modes. */
  readonly basis: Float32Array<ArrayBuffer>;
  /** [nodes, 3, 4 quads]: rotation vector, the same way. */
  readonly turn: Float32Array<ArrayBuffer>;
  /** [nodes, 3] rest position, and [nodes] node before it on its branch; its own index: none. */
  readonly rest_m: Float32Array<ArrayBuffer>;
  readonly parent: Uint16Array<ArrayBuffer>;
  /** Its nodes by which an impostor bends, halfway up the trunk and at the tip. */
  readonly bend: readonly [middle: number, tip: number];
}

/** The part of a table by which trees are drawn, unpacked by the worker. */
export interface DrawnMotion {
  readonly modes: number;
  /** Floats per tree in a pose buffer: the modes, the local wind speed in m/s, padding to a multiple of four. */
  readonly stride: number;
  readonly nodes: number;
  /** [nodes, 3, stride]: displacement in m per unit of each coordinate, zero beyond the modes. */
  readonly basis: Float32Array<ArrayBuffer>;
  /** [nodes, 3, stride]: rotation vector per unit of each coordinate, zero beyond the modes. */
  readonly turn: Float32Array<ArrayBuffer>;
  /** [nodes, 3] rest position of each node, tree frame. */
  readonly rest_m: Float32Array<ArrayBuffer>;
  /** Node before each node on its branch, never a later one; its own index: none. */
  readonly parent: Uint16Array<ArrayBuffer>;
  /** [joints, 2] nodes, [joints] share of the second, and [joints, 3] rest position of the joints. */
  readonly jointNodes: Uint16Array<ArrayBuffer>;
  readonly jointShare: Float32Array<ArrayBuffer>;
  readonly jointRest_m: Float32Array<ArrayBuffer>;
  /** Joint of each render vertex, primitives concatenated. */
  readonly vertexJoint: Uint16Array<ArrayBuffer>;
  /** One per level of detail of the mesh: full detail first, then with fewer nodes and modes; the last is of trees that are cards only. */
  readonly levels: readonly NodeLevel[];
  /** Largest displacement of any part of a tree of scale 1, m. */
  readonly reach_m: number;
  readonly height_m: number;
}
