/** Reads a normalised GLB into the parts that the forest draws. */
import {
  BufferAttribute,
  type BufferGeometry,
  type InterleavedBufferAttribute,
  Mesh,
  type MeshStandardMaterial,
  type Object3D,
  Texture,
  Vector3,
} from "three";
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
import { leafFreedom, roundNormals } from "./foliage";
import type { PartGeometry } from "./limbs";
import type { SingleLeaves } from "./singleLeaves";

/** Wood moves with its branch; leaves also flutter and are lit from both sides. */
export type Part = "wood" | "leaves";

export interface TreePart {
  readonly kind: Part;
  readonly vertices: number;
  readonly material: MeshStandardMaterial;
  readonly normal: BufferAttribute;
  readonly uv: BufferAttribute | null;
  /** Linear colours (red, green, blue) by which the material's colour is multiplied; null: none. */
  readonly colour: BufferAttribute | null;
  readonly position: BufferAttribute;
  /** The point to which the vertex's leaf or branch shrinks, and the key of its limb (limbKeys.ts). */
  readonly anchor: BufferAttribute;
  /**
   * Random number of the piece, openness to the sky (0..1; 1 unless the reader of a scene knows it), freedom of the leaf vertex to
   * flutter, rank of the piece.
   */
  readonly piece: BufferAttribute;
  /** The vertex whose node each vertex uses: a small leaf is bound to a single node, so that it keeps its shape. */
  readonly hold: Uint32Array;
  /** Triangles sorted by rank, and the number of indices drawn at each level of detail. */
  readonly index: BufferAttribute;
  readonly counts: readonly number[];
}

/** What is drawn in addition to a part of the file. Its `hold` names vertices of that part. */
export interface AddedPart {
  readonly part: TreePart;
  /** Index of the part. */
  readonly of: number;
}

export interface TreeModel {
  readonly parts: readonly TreePart[];
  /** Drawn in place of leaves that have fallen. Made when first asked for: only bare trees need it. */
  readonly bare: readonly AddedPart[];
  /** Drawn always. */
  readonly added: readonly AddedPart[];
  /**
   * Drawn of trees near the eye, which show a share of pieces above 1: what has a rank from `NEAR_RANK` on appears, and leaves
   * disappear in the same order. Made when first asked for, like `bare`.
   */
  readonly near: readonly AddedPart[];
  /** Drawn one by one close to the eye, in place of leaves and their near parts; without it none are. Made when first asked for. */
  readonly singles?: SingleLeaves | null;
  /** Those of all parts. */
  readonly materials: readonly MeshStandardMaterial[];
  /** Whether each tree has a lean of its own (lean.ts). */
  readonly leans: boolean;
  /** Whether the leaves stay in winter. */
  readonly evergreen: boolean;
  readonly height_m: number;
  /** Largest horizontal reach from the trunk. */
  readonly radius_m: number;
}

const isMesh = (object: Object3D): object is Mesh<BufferGeometry, MeshStandardMaterial> =>
  object instanceof Mesh;

/** Meshes in table order (wood_0, wood_1, …, twigs_0, …, leaves_0, …), which is the order in the file. */
function meshesOf(scene: Object3D): Mesh<BufferGeometry, MeshStandardMaterial>[] {
  const meshes: Mesh<BufferGeometry, MeshStandardMaterial>[] = [];
  scene.traverse((object) => {
    if (isMesh(object)) meshes.push(object);
  });
  const rank = ({ name }: Mesh) =>
    1e6 * (KINDS.findIndex((kind) => name.startsWith(kind)) + 1) + Number(/(\d+)$/.exec(name)?.[1] ?? 0);
  return meshes.sort((a, b) => rank(a) - rank(b));
}

/** Kinds of primitives that come after the wood. Twigs are drawn like wood: they stay when leaves have fallen. */
const KINDS = ["twigs", "leaves"];
const kindOf = (mesh: Object3D): Part => (mesh.name.startsWith("leaves") ? "leaves" : "wood");

function floats(
  attribute: { count: number; itemSize: number } & Pick<BufferAttribute, "getComponent">,
): Float32Array {
  const { array, normalized, data } = attribute as Partial<BufferAttribute & InterleavedBufferAttribute>;
  if (array instanceof Float32Array && !normalized && !data) return array.slice();
  const { count, itemSize } = attribute;
  return rowsOf(attribute, count, itemSize);
}

/** The first `columns` components of each row, as three.js reads them. */
function rowsOf(from: Pick<BufferAttribute, "getComponent">, rows: number, columns: number): Float32Array {
  const out = new Float32Array(rows * columns);
  for (let row = 0, i = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++, i++) out[i] = from.getComponent(row, column);
  }
  return out;
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

/** A part with the pieces that its variants are made from. */
export interface ReadPart {
  readonly part: TreePart;
  readonly geometry: PartGeometry;
}

function partFrom(
  mesh: Mesh<BufferGeometry, MeshStandardMaterial>,
  centre: Vector3,
  bare: boolean,
): ReadPart {
  const { geometry } = mesh;
  const kind = kindOf(mesh);
  if (!geometry.getAttribute("normal")) geometry.computeVertexNormals();
  const positions = floats(geometry.getAttribute("position") as BufferAttribute);
  const vertices = positions.length / 3;
  const index = geometry.index?.array ?? separate(vertices);
  const pieces = connectedComponents(index, vertices);
  const leaves = kind === "leaves";
  const normals = floats(geometry.getAttribute("normal") as BufferAttribute);
  const reach = leaves ? leafFreedom(pieces, positions) : new Float32Array(vertices);
  const { ranks, anchors, of } = leaves ? leafDetail(pieces, positions) : woodDetail(index, positions, bare);
  const piece = new Float32Array(vertices * 4);
  const anchor = new Float32Array(vertices * 4).fill(COMMON_KEY);
  for (let v = 0; v < vertices; v++) {
    piece[4 * v] = hashUnit(pieces.ofVertex[v], 3);
    piece[4 * v + 1] = 1;
    piece[4 * v + 2] = reach[v];
    piece[4 * v + 3] = ranks[of.ofVertex[v]];
    for (let axis = 0; axis < 3; axis++) anchor[v * 4 + axis] = anchors[of.ofVertex[v] * 3 + axis];
  }
  const ranked = rankedIndex(index, (v) => ranks[of.ofVertex[v]]);
  const uv = geometry.getAttribute("uv") as BufferAttribute | undefined;
  const part: TreePart = {
    kind,
    vertices,
    material: mesh.material,
    normal: new BufferAttribute(leaves ? roundNormals(positions, normals, centre) : normals, 3),
    uv: uv ? new BufferAttribute(floats(uv), 2) : null,
    colour: colourOf(geometry),
    position: new BufferAttribute(positions, 3),
    anchor: new BufferAttribute(anchor, 4),
    piece: new BufferAttribute(piece, 4),
    hold: leaves ? holders(pieces) : separate(vertices),
    index: new BufferAttribute(ranked.index, 1),
    counts: ranked.counts,
  };
  const partKind = leaves ? "leaves" : isTwigs(mesh) ? "twigs" : "wood";
  return { part, geometry: { kind: partKind, positions, index, pieces: of } };
}

/** Colours of the vertices without their alpha; three.js calls the attribute "color". */
function colourOf(geometry: BufferGeometry): BufferAttribute | null {
  const given = geometry.getAttribute("color") as BufferAttribute | undefined;
  if (!given) return null;
  return new BufferAttribute(rowsOf(given, given.count, 3), 3);
}

const isTwigs = ({ name }: Object3D) => name.startsWith("twigs");

/** The parts of an opened GLB, and the size of the tree; throws if it contains no mesh. */
export function readParts(scene: Object3D): { read: ReadPart[]; height_m: number; radius_m: number } {
  const meshes = meshesOf(scene);
  if (meshes.length === 0) throw new Error("the tree's mesh file contains no mesh");
  const low = new Vector3(Infinity, Infinity, Infinity);
  const high = low.clone().negate();
  for (const mesh of meshes) {
    mesh.geometry.computeBoundingBox();
    low.min(mesh.geometry.boundingBox?.min ?? low);
    high.max(mesh.geometry.boundingBox?.max ?? high);
  }
  const radius_m = Math.max(Math.abs(low.x), Math.abs(low.z), high.x, high.z, 0.1);
  const centre = new Vector3((low.x + high.x) / 2, 0.25 * low.y + 0.62 * high.y, (low.z + high.z) / 2);
  const bare = meshes.every((mesh) => kindOf(mesh) === "wood"); // a tree without leaves
  const read = meshes.map((mesh) => partFrom(mesh, centre, bare));
  for (const mesh of meshes) mesh.geometry.dispose();
  return { read, height_m: high.y, radius_m };
}

/** Reads an opened GLB: complete trees, without shoots in place of leaves. */
export function readPlainTree(scene: Object3D): TreeModel {
  const { read, height_m, radius_m } = readParts(scene);
  const parts = read.map(({ part }) => part);
  return {
    parts,
    materials: parts.map(({ material }) => material),
    bare: [],
    added: [],
    near: [],
    leans: false,
    evergreen: false,
    height_m,
    radius_m,
  };
}

/** Frees the GPU resources of a model; they are uploaded again when it is drawn again. */
export function disposeModel({ materials }: TreeModel): void {
  for (const material of materials) {
    for (const one of Object.values(material)) if (one instanceof Texture) one.dispose();
    material.dispose();
  }
}
