/** Stand-ins for the first tree, with which the driver compiles its shaders while its mesh is still loading. */
import type { Part, SpeciesOptions, SpeciesUniforms } from "galewood/trees";
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  FloatType,
  Group,
  type Material,
  Mesh,
  MeshStandardMaterial,
  RGBAFormat,
  RGBAIntegerFormat,
  UnsignedIntType,
} from "three";

/** A material as the files of the built-in trees have it: what determines the code of its shader, not what it shows. */
function asInFile(part: Part): MeshStandardMaterial {
  const leaves = part === "leaves";
  const map = new DataTexture(new Uint8Array(4), 1, 1);
  const material = new MeshStandardMaterial({
    map,
    normalMap: leaves ? null : map,
    alphaTest: leaves ? 0.5 : 0,
  });
  material.userData = leaves ? { shoots: true } : { merged: true };
  return material;
}

/** The attributes by which three.js chooses the code of a shader. */
function attributed(): BufferGeometry {
  const geometry = new BufferGeometry();
  const sizes = { position: 3, normal: 3, uv: 2, color: 3 };
  for (const [name, size] of Object.entries(sizes))
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(size), size));
  return geometry;
}

/** Textures of one texel in place of the data of trees: without them, drivers refuse to draw. */
function emptyData() {
  const nodes = new DataTexture(new Uint32Array(4), 1, 1, RGBAIntegerFormat, UnsignedIntType);
  nodes.internalFormat = "RGBA32UI";
  nodes.needsUpdate = true;
  return { nodes, numbers: new DataTexture(new Float32Array(4), 1, 1, RGBAFormat, FloatType) };
}

/** A mesh of wood and one of leaves, one point each. Their shaders are kept until they are disposed of. */
export class StandIns {
  readonly group = new Group();
  private readonly materials: Material[] = [];
  private readonly data = emptyData();

  constructor({ materials, together }: SpeciesOptions) {
    // Other values do not matter, only which there are.
    const { nodes, numbers } = this.data;
    const uniforms = {
      uNodes: { value: nodes },
      uPullField: { value: numbers },
      ...(together && { together: { seen: { uTrees: { value: numbers } }, casting: {} } }),
    } as unknown as SpeciesUniforms;
    const geometry = attributed();
    for (const part of ["wood", "leaves"] as const) {
      const { colour } = materials(asInFile(part), part, uniforms, true);
      colour.vertexColors = true;
      const mesh = new Mesh(geometry, colour);
      mesh.receiveShadow = true;
      this.group.add(mesh);
      this.materials.push(colour);
    }
  }

  dispose(): void {
    for (const material of this.materials.splice(0)) material.dispose();
    for (const texture of Object.values(this.data)) texture.dispose();
  }
}
