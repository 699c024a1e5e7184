/** The materials of trees as a scene gives them, before the motion is added. */
import { DoubleSide, type Material, type MeshStandardMaterial } from "three";
import type { Part } from "../trees/mesh/partArrays";

/** Makes the material of a part of a tree from that of its mesh. Called once per part: return a new material each time. */
export type MaterialFactory = (part: Part, original: MeshStandardMaterial) => Material;

const ALPHA_TEST = 0.42;
/** Share of the alpha of leaves that each mip level loses. */
export const LOST_ALPHA = 0.14;

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

const claimed = new WeakSet<Material>();

/** A material that no other part has; throws if one has. */
export function claim(material: Material): Material {
  if (claimed.has(material)) throw new Error("materials: return a new material for every part of a tree");
  claimed.add(material);
  return material;
}
