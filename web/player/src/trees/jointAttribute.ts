/** How the vertices of a part are held: between which nodes, and where. */
import { BufferAttribute } from "three";
import type { DrawnMotion, NodeLevel } from "../core/table/drawnTable";
import type { TreePart } from "./mesh/treeMesh";

/** Largest value of the third number of a joint attribute: the whole share of its second node. */
export const WHOLE_SHARE = 65535;

/**
 * Both nodes of the joint of each vertex of one part at one level, the share of the second, and the vertex itself (modulo
 * 2¹⁶), for parts that are added to those of the file.
 */
export function jointAttribute(part: TreePart, firstVertex: number, motion: DrawnMotion, level: NodeLevel) {
  const joints = new Uint16Array(4 * part.vertices);
  part.hold.forEach((vertex, v) => {
    const joint = motion.vertexJoint[firstVertex + vertex];
    const share = Math.round(WHOLE_SHARE * motion.jointShare[joint]);
    const first = level.of[motion.jointNodes[2 * joint]];
    const second = level.of[motion.jointNodes[2 * joint + 1]];
    const two = share > 0 && first !== second;
    joints[4 * v] = first;
    joints[4 * v + 1] = two ? second : first;
    joints[4 * v + 2] = two ? share : 0;
    joints[4 * v + 3] = firstVertex + vertex;
  });
  return new BufferAttribute(joints, 4);
}

/** The place of the joint of each vertex of one part, about which the vertex turns. */
export function pivotAttribute(part: TreePart, firstVertex: number, motion: DrawnMotion) {
  const pivots = new Float32Array(3 * part.vertices);
  part.hold.forEach((vertex, v) => {
    const at = 3 * motion.vertexJoint[firstVertex + vertex];
    for (let axis = 0; axis < 3; axis++) pivots[3 * v + axis] = motion.jointRest_m[at + axis];
  });
  return new BufferAttribute(pivots, 3);
}
