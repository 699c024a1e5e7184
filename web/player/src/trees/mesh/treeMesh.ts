/** The parts of a normalised GLB as they are drawn. */
import {
  BufferAttribute,
  type BufferGeometry,
  type InterleavedBufferAttribute,
  Mesh,
  type MeshStandardMaterial,
  type Object3D,
  Texture,
} from "three";
import { separate } from "./components";
import { kindOf, type MeshArrays, type PartArrays, readMeshes } from "./partArrays";
import type { SingleLeaves } from "./singleLeaves";

/** A part as it is drawn; partArrays.ts says what its attributes are. */
export interface TreePart extends Pick<PartArrays, "kind" | "vertices" | "hold" | "counts"> {
  readonly material: MeshStandardMaterial;
  readonly normal: BufferAttribute;
  readonly uv: BufferAttribute | null;
  readonly colour: BufferAttribute | null;
  readonly position: BufferAttribute;
  readonly anchor: BufferAttribute;
  readonly piece: BufferAttribute;
  readonly index: BufferAttribute;
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
  /** Mean frequency of the flutter of its leaves, Hz, if it is known. */
  readonly flutter_hz?: number;
  readonly height_m: number;
  /** Largest horizontal reach from the trunk. */
  readonly radius_m: number;
}

type DrawnMesh = Mesh<BufferGeometry, MeshStandardMaterial>;

const isMesh = (object: Object3D): object is DrawnMesh => object instanceof Mesh;

/** Meshes in table order (wood_0, wood_1, …, twigs_0, …, leaves_0, …), which is the order in the file. */
function meshesOf(scene: Object3D): DrawnMesh[] {
  const meshes: DrawnMesh[] = [];
  scene.traverse((object) => {
    if (isMesh(object)) meshes.push(object);
  });
  const rank = ({ name }: Mesh) => 1e6 * kindOf(name) + Number(/\d*$/.exec(name));
  return meshes.sort((a, b) => rank(a) - rank(b));
}

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** The first `columns` components of each vertex, as three.js reads them. */
function rowsOf(attribute: Attribute, columns: number): Float32Array {
  const { array, itemSize } = attribute;
  if (array instanceof Float32Array && itemSize === columns && !("data" in attribute)) return array.slice();
  const out = new Float32Array(attribute.count * columns);
  for (let row = 0, i = 0; row < attribute.count; row++) {
    for (let column = 0; column < columns; column++, i++) out[i] = attribute.getComponent(row, column);
  }
  return out;
}

function arraysOf({ name, geometry }: DrawnMesh): MeshArrays {
  if (!geometry.getAttribute("normal")) geometry.computeVertexNormals();
  const rows = (attribute: string, columns: number) => {
    const given = geometry.getAttribute(attribute) as Attribute | undefined;
    return given ? rowsOf(given, columns) : null;
  };
  const positions = rows("position", 3) as Float32Array;
  return {
    name,
    positions,
    normals: rows("normal", 3) as Float32Array,
    uvs: rows("uv", 2),
    colours: rows("color", 3), // three.js calls the attribute so; without alpha
    index: (geometry.index?.array as Uint16Array | undefined) ?? separate(positions.length / 3),
  };
}

/** What an opened GLB contains, in table order: its meshes and the material of each. */
export interface OpenedMeshes {
  readonly meshes: readonly MeshArrays[];
  readonly materials: readonly MeshStandardMaterial[];
}

/** The meshes of an opened GLB, whose geometries are disposed of; throws if it contains none. */
export function openedMeshes(scene: Object3D): OpenedMeshes {
  const drawn = meshesOf(scene);
  if (drawn.length === 0) throw new Error("the tree's mesh file contains no mesh");
  const meshes = drawn.map(arraysOf);
  for (const { geometry } of drawn) geometry.dispose();
  return { meshes, materials: drawn.map(({ material }) => material) };
}

/** The part as it is drawn with this material. */
export function drawnPart(part: PartArrays, material: MeshStandardMaterial): TreePart {
  const { normals, uvs, colours, positions, anchors, pieces, index, ...same } = part;
  const attribute = (array: Float32Array | Uint32Array, size: number) => new BufferAttribute(array, size);
  return {
    ...same,
    material,
    normal: attribute(normals, 3),
    uv: uvs && attribute(uvs, 2),
    colour: colours && attribute(colours, 3),
    position: attribute(positions, 3),
    anchor: attribute(anchors, 4),
    piece: attribute(pieces, 4),
    index: attribute(index, 1),
  };
}

/** Reads an opened GLB: complete trees, without shoots in place of leaves. */
export function readPlainTree(scene: Object3D): TreeModel {
  const { meshes, materials } = openedMeshes(scene);
  const { read, height_m, radius_m } = readMeshes(meshes);
  return {
    parts: read.map(({ part }, k) => drawnPart(part, materials[k])),
    materials,
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
