/** Materials of trees for WebGLRenderer: any of three.js, with the motion added to their shaders. */
import {
  type Material,
  MeshDepthMaterial,
  MeshDistanceMaterial,
  RGBADepthPacking,
  type Texture,
  type WebGLProgramParametersWithUniforms,
} from "three";
import { deform } from "../trees/treeShader";
import type { Materials } from "./baseForest";
import { claim, LOST_ALPHA } from "./ownMaterial";

/** Mip levels reduce the alpha coverage of leaves: restore it. */
const LEAF_MAP = /* glsl */ `
#include <map_fragment>
#ifdef USE_MAP
  vec2 texels = vec2(textureSize(map, 0));
  vec2 right = dFdx(vMapUv) * texels;
  vec2 down = dFdy(vMapUv) * texels;
  diffuseColor.a *= 1.0 + ${LOST_ALPHA} * max(0.0, log2(abs(right.x * down.y - right.y * down.x) + 1e-4));
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

/** Materials of a forest. */
export const makerOf: Materials = (factory, leafShare) => (from, part, given, moves) => {
  const colour = claim(factory(part, from));
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

// From here, because shader code that lies together in the built file compresses better.
export { GLSL_GRAPHICS } from "../trees/nodes/glslNodes";
