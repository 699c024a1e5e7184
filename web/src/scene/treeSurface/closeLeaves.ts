/** Draws the leaves of one species one by one close to the eye: a call for each shape of a spray. */
import {
  CLOSE_FLOATS,
  type CloseLeaves,
  type DrawList,
  fillClose,
  type HeldSprays,
  type LevelTexels,
  type SingleLeaves,
  type SpeciesUniforms,
  type SprayRoom,
  type SprayShape,
  type TreeModel,
  type View,
} from "galewood/trees";
import {
  BufferAttribute,
  DynamicDrawUsage,
  type Group,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  type Material,
  Mesh,
} from "three";
import { CLOSE_ATTRIBUTES } from "./closeShader";
import { type MaterialOptions, singlesMaterial } from "./treeMaterial";

interface Shape extends SprayRoom {
  readonly mesh: Mesh<InstancedBufferGeometry, Material>;
}

function geometryOf({ positions, normals, uvs, leaves, index }: SprayShape): InstancedBufferGeometry {
  const geometry = new InstancedBufferGeometry();
  geometry.setIndex(new BufferAttribute(index, 1));
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3));
  geometry.setAttribute("uv", new BufferAttribute(uvs, 2));
  geometry.setAttribute("aLeaf", new BufferAttribute(leaves, 4));
  return geometry;
}

/** Gives the shape its instances, in a buffer of its own while they fit. */
function upload({ mesh: { geometry }, data, count }: Shape): void {
  const known = geometry.getAttribute("aPlace") as InterleavedBufferAttribute | undefined;
  let buffer = known?.data;
  if (buffer?.array !== data) {
    geometry.dispose(); // what has been drawn is bound to the former buffer
    buffer = new InstancedInterleavedBuffer(data, CLOSE_FLOATS).setUsage(DynamicDrawUsage);
    let from = 0;
    for (const [name, floats] of CLOSE_ATTRIBUTES) {
      geometry.setAttribute(name, new InterleavedBufferAttribute(buffer, floats, from));
      from += floats;
    }
  }
  geometry.instanceCount = count;
  buffer.clearUpdateRanges();
  buffer.addUpdateRange(0, count * CLOSE_FLOATS);
  buffer.needsUpdate = true;
}

/** Draws the shapes of one tree model. */
class ShapeMeshes {
  readonly shapes: readonly Shape[];
  readonly held: HeldSprays;

  constructor(
    singles: SingleLeaves,
    { height_m, radius_m, leans }: TreeModel,
    motion: HeldSprays["motion"],
    uniforms: SpeciesUniforms,
    options: MaterialOptions,
    group: Group,
  ) {
    const { shapeOf, sprays, hold } = singles;
    this.held = { shapeOf, sprays, hold, motion, height_m, radius_m, leans };
    const added = { ...uniforms, uPullFirst: { value: -1 } };
    const material = singlesMaterial(singles.material, added, options);
    this.shapes = singles.shapes.map((shape) => {
      const mesh = new Mesh(geometryOf(shape), material);
      mesh.frustumCulled = false;
      mesh.matrixAutoUpdate = false;
      mesh.raycast = () => {}; // trees are picked by their nodes
      mesh.receiveShadow = true;
      group.add(mesh);
      return { mesh, data: new Float32Array(0), count: 0 };
    });
  }

  dispose(): void {
    for (const { mesh } of this.shapes) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }
}

/** Whether the first tree of a list, the nearest one in full detail, shows near parts. */
const isNear = (list: DrawList): boolean => list.visible[0] > 0 && list.share[list.order[list.start[0]]] > 1;

export class SingleLeafMeshes implements CloseLeaves {
  /** Made when a tree is near for the first time. */
  private meshes: ShapeMeshes | null = null;

  constructor(
    private readonly model: TreeModel,
    private readonly motion: HeldSprays["motion"],
    private readonly uniforms: SpeciesUniforms,
    private readonly options: MaterialOptions,
    private readonly group: Group,
  ) {}

  show(
    list: DrawList,
    instances: Float32Array,
    texels: readonly LevelTexels[],
    { eye, close_m = 0 }: View,
  ): void {
    const within_m = isNear(list) ? close_m : 0; // never of bare trees
    if (within_m > 0) this.meshes ??= this.make();
    if (!this.meshes) return;
    Object.assign(this.uniforms.uClose.value, { x: eye.x, y: eye.y, z: eye.z, w: within_m });
    const { shapes, held } = this.meshes;
    fillClose(shapes, held, list, instances, texels, eye, within_m);
    for (const shape of shapes) {
      shape.mesh.visible = shape.count > 0;
      if (shape.count > 0) upload(shape);
    }
  }

  private make(): ShapeMeshes | null {
    const { model, motion, uniforms, options, group } = this;
    return model.singles ? new ShapeMeshes(model.singles, model, motion, uniforms, options, group) : null;
  }

  get triangles(): number {
    const shapes = this.meshes?.shapes ?? [];
    return shapes.reduce((sum, { mesh, count }) => sum + (count * (mesh.geometry.index?.count ?? 0)) / 3, 0);
  }

  dispose(): void {
    this.meshes?.dispose();
  }
}
