/** Stand-ins for the first tree, so that the driver compiles its shaders while its mesh is still loading. */
import type { Part, SpeciesOptions, SpeciesUniforms } from "galewood/trees";
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  Group,
  type Material,
  Mesh,
  MeshStandardMaterial,
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

/** A mesh of wood and one of leaves, to be compiled, not to be drawn. Their shaders are kept until they are disposed of. */
export class StandIns {
  readonly group = new Group();
  private readonly materials: Material[] = [];

  constructor({ materials, together }: SpeciesOptions) {
    // Values of uniforms do not matter, only which there are.
    const uniforms = { ...(together && { together: { seen: {}, casting: {} } }) } as SpeciesUniforms;
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
  }
}
