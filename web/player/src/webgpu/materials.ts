/** Materials of trees for WebGPURenderer: any of three.js or of nodes, with the motion added as their position. */
import { DoubleSide, type Material, type Texture } from "three";
import {
  abs,
  dFdx,
  dFdy,
  faceDirection,
  log2,
  materialNormal,
  materialOpacity,
  max,
  positionGeometry,
  texture,
  textureSize,
  uv,
  vec2,
} from "three/tsl";
import type { Node } from "three/webgpu";
import type { Materials } from "../three/baseForest";
import { claim, LOST_ALPHA } from "../three/ownMaterial";
import { swaying } from "./treeNodes";

/**
 * Any material with these is drawn with them: WebGPURenderer makes a node material of each other one, and copies all that it
 * has.
 */
type WithNodes = Material & {
  isNodeMaterial?: true;
  positionNode?: Node<"vec3"> | null;
  normalNode?: Node<"vec3"> | null;
  opacityNode?: Node<"float"> | null;
};

/** Mip levels reduce the alpha coverage of leaves: the factor that restores it. */
function coverage(map: Texture): Node<"float"> {
  const texels = vec2(textureSize(texture(map)) as unknown as Node<"ivec2">); // as both shading languages have it
  const [right, down] = [dFdx(uv()).mul(texels), dFdy(uv()).mul(texels)];
  const area = abs(right.x.mul(down.y).sub(right.y.mul(down.x))).add(1e-4);
  return max(0, log2(area)).mul(LOST_ALPHA).add(1);
}

function shapeLeaves(material: WithNodes & { map?: Texture | null }): void {
  if (material.map)
    material.opacityNode = (material.opacityNode ?? materialOpacity).mul(coverage(material.map));
  // The normals of leaves are those of the crown: the same from both sides.
  if (material.side === DoubleSide)
    material.normalNode = (material.normalNode ?? materialNormal).mul(faceDirection);
}

/** WebGPURenderer shares programs among materials that look alike to it, and sees no nodes in those that are not made of them. */
function keepApart(material: WithNodes): void {
  if (material.isNodeMaterial) return;
  const key = `${material.customProgramCacheKey()} galewood ${material.uuid}`;
  material.customProgramCacheKey = () => key;
}

/** Materials of a forest. */
export const makerOf: Materials = (factory, leafShare) => (from, part, uniforms) => {
  const colour: WithNodes = claim(factory(part, from));
  const rest = colour.positionNode ?? positionGeometry;
  colour.positionNode = swaying(part, rest, uniforms, leafShare);
  if (part === "leaves") shapeLeaves(colour);
  keepApart(colour);
  return { colour };
};
