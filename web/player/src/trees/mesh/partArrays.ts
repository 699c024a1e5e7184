/** Makes the parts that a forest draws of the meshes of a tree. Pure, and without three.js, so that a worker can do it. */
import { hashUnit } from "../../core/math/random";
import { branchBases, leafRanks, rankedIndex, woodRanks } from "../detail";
import { COMMON_KEY } from "../variantShader";
import {
  type Components,
  connectedComponents,
  holders,
  petioles,
  separate,
  weldedComponents,
} from "./components";
import { leafFreedom, type Point, roundNormals } from "./foliage";
import type { PartGeometry } from "./limbs";

/** Wood moves with its branch; leaves also flutter and are lit from both sides. */
export type Part = "wood" | "leaves";

/** A mesh as it is in the file: 3 numbers per vertex, of `uvs` 2. */
export interface MeshArrays {
  /** Begins with its kind: "wood", "twigs" or "leaves". */
  readonly name: string;
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly uvs: Float32Array | null;
  readonly colours: Float32Array | null;
  readonly index: Uint16Array | Uint32Array;
}

/** What a part has besides its material; `TreePart` has the same as attributes. */
export interface PartArrays {
  readonly kind: Part;
  readonly vertices: number;
  readonly normals: Float32Array;
  readonly uvs: Float32Array | null;
  /** Linear colours (red, green, blue) by which the material's colour is multiplied; null: none. */
  readonly colours: Float32Array | null;
  readonly positions: Float32Array;
  /** The point to which the vertex's leaf or branch shrinks, and the key of its limb (limbKeys.ts): 4 numbers. */
  readonly anchors: Float32Array;
  /**
   * Random number of the piece, openness to the sky (0..1; 1 unless the reader of a scene knows it), freedom of the leaf vertex to
   * flutter, rank of the piece: 4 numbers.
   */
  readonly pieces: Float32Array;
  /** The vertex whose node each vertex uses: a small leaf is bound to a single node, so that it keeps its shape. */
  readonly hold: Uint32Array;
  /** Triangles sorted by rank, and the number of indices drawn at each level of detail. */
  readonly index: Uint32Array;
  readonly counts: readonly number[];
}

/** A part with the pieces that its variants are made from. */
export interface ReadPart {
  readonly part: PartArrays;
  readonly geometry: PartGeometry;
}

/** The parts of a tree and its size. */
export interface ReadMeshes {
  readonly read: readonly ReadPart[];
  readonly height_m: number;
  /** Largest horizontal reach from the trunk. */
  readonly radius_m: number;
}

interface PieceDetail {
  readonly of: Components;
  readonly ranks: Float32Array;
  readonly anchors: Float32Array;
}

const leafDetail = (of: Components, positions: Float32Array): PieceDetail => ({
  of,
  ranks: leafRanks(of),
  anchors: petioles(of, positions),
});

/** A bare tree consists of branches only: they keep rank 0 and are always drawn. */
function woodDetail(index: ArrayLike<number>, positions: Float32Array, bare: boolean): PieceDetail {
  const of = weldedComponents(index, positions);
  const ranks = bare ? new Float32Array(of.count) : woodRanks(of, positions);
  return { of, ranks, anchors: branchBases(of, positions) };
}

/** Kinds of meshes in table order. Twigs are drawn like wood: they stay when leaves have fallen. */
const TABLE_ORDER = ["wood", "twigs", "leaves"] as const;

/** What a mesh is, by its name, as an index of `TABLE_ORDER`. */
export const kindOf = (name: string): number =>
  Math.max(
    0,
    TABLE_ORDER.findIndex((kind) => name.startsWith(kind)),
  );

function partFrom(mesh: MeshArrays, centre: Point, bare: boolean): ReadPart {
  const { positions, normals, uvs, colours, index } = mesh;
  const kind = TABLE_ORDER[kindOf(mesh.name)];
  const leaves = kind === "leaves";
  const vertices = positions.length / 3;
  const connected = connectedComponents(index, vertices);
  const reach = leaves ? leafFreedom(connected, positions) : new Float32Array(vertices);
  const detail = leaves ? leafDetail(connected, positions) : woodDetail(index, positions, bare);
  const { ranks, anchors: shrinkTo, of } = detail;
  const pieces = new Float32Array(vertices * 4);
  const anchors = new Float32Array(vertices * 4).fill(COMMON_KEY);
  for (let v = 0; v < vertices; v++) {
    pieces[4 * v] = hashUnit(connected.ofVertex[v], 3);
    pieces[4 * v + 1] = 1;
    pieces[4 * v + 2] = reach[v];
    pieces[4 * v + 3] = ranks[of.ofVertex[v]];
    for (let axis = 0; axis < 3; axis++) anchors[v * 4 + axis] = shrinkTo[of.ofVertex[v] * 3 + axis];
  }
  const part: PartArrays = {
    kind: leaves ? "leaves" : "wood",
    vertices,
    normals: leaves ? roundNormals(positions, normals, centre) : normals,
    uvs,
    colours,
    positions,
    anchors,
    pieces,
    hold: leaves ? holders(connected) : separate(vertices),
    ...rankedIndex(index, (v) => ranks[of.ofVertex[v]]),
  };
  return { part, geometry: { kind, positions, index, pieces: of } };
}

/** The parts of meshes in table order. */
export function readMeshes(meshes: readonly MeshArrays[]): ReadMeshes {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { positions } of meshes) {
    for (let i = 0; i < positions.length; i++) {
      low[i % 3] = Math.min(low[i % 3], positions[i]);
      high[i % 3] = Math.max(high[i % 3], positions[i]);
    }
  }
  const centre = { x: (low[0] + high[0]) / 2, y: 0.25 * low[1] + 0.62 * high[1], z: (low[2] + high[2]) / 2 };
  const bare = !meshes.some(({ name }) => TABLE_ORDER[kindOf(name)] === "leaves");
  return {
    read: meshes.map((mesh) => partFrom(mesh, centre, bare)),
    height_m: high[1],
    radius_m: Math.max(Math.abs(low[0]), Math.abs(low[2]), high[0], high[2], 0.1),
  };
}
