/** Materials of trees: any of three.js, with the motion added to their shaders. */
import {
  DoubleSide,
  type Material,
  MeshDepthMaterial,
  MeshDistanceMaterial,
  type MeshStandardMaterial,
  RGBADepthPacking,
  type Texture,
  type WebGLProgramParametersWithUniforms,
} from "three";
import type { Part } from "../trees/mesh/treeMesh";
import type { MaterialMaker } from "../trees/partMaterials";
import { deform } from "../trees/treeShader";

/** Makes the material of a part of a tree from that of its mesh. Called once per part: return a new material each time. */
export type MaterialFactory = (part: Part, original: MeshStandardMaterial) => Material;

const ALPHA_TEST = 0.42;

/** The material of the mesh itself; leaves are cut out and lit from both sides. */
export const ownMaterial: MaterialFactory = (part, original) => {
  const material = original.clone();
  if (part === "leaves") material.side = DoubleSide;
  if (part === "leaves" && (material.transparent || material.alphaTest > 0)) {
    material.transparent = false;
    material.alphaTest = ALPHA_TEST;
  }
  return material;
};

/** Mip levels reduce the alpha coverage of leaves: restore it. */
const LEAF_MAP = /* glsl */ `
#include <map_fragment>
#ifdef USE_MAP
  vec2 texels = vec2(textureSize(map, 0));
  vec2 right = dFdx(vMapUv) * texels;
  vec2 down = dFdy(vMapUv) * texels;
  diffuseColor.a *= 1.0 + 0.14 * max(0.0, log2(abs(right.x * down.y - right.y * down.x) + 1e-4));
#endif
`;

/** The normals of leaves are those of the crown: the same from both sides. */
const LEAF_NORMAL = /* glsl */ `
#include <normal_fragment_begin>
#if defined(DOUBLE_SIDED) && !defined(FLAT_SHADED)
  normal *= faceDirection;
#endif
`;

function patchLeaves(shader: WebGLProgramParametersWithUniforms): void {
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <map_fragment>", LEAF_MAP)
    .replace("#include <normal_fragment_begin>", LEAF_NORMAL);
}

const patched = new WeakSet<Material>();

/** Materials by a factory, with the deformation of the trees. `uLeafShare`: share of the leaves on the trees. */
export function makerOf(factory: MaterialFactory, leafShare: { value: number }): MaterialMaker {
  return (from, part, given, moves) => {
    const colour = factory(part, from);
    if (patched.has(colour)) throw new Error("materials: return a new material for every part of a tree");
    patched.add(colour);
    const uniforms = { ...given, uLeafShare: leafShare };
    const variant = { part, moves, standing: "oriented" } as const;
    const leaves = part === "leaves" ? patchLeaves : undefined;
    deform(colour, { ...variant, key: `plain-${colour.type}` }, uniforms, leaves);
    const { map = null, alphaTest } = colour as Material & { map?: Texture | null };
    const cut = { map: alphaTest > 0 ? map : null, alphaTest };
    const shadow = new MeshDepthMaterial({ ...cut, depthPacking: RGBADepthPacking });
    const distance = new MeshDistanceMaterial(cut);
    deform(shadow, { ...variant, key: "depth" }, uniforms);
    deform(distance, { ...variant, key: "distance" }, uniforms);
    return { colour, shadow, distance };
  };
}
