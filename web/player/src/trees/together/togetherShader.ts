/** Shader code of trees whose levels of detail are drawn with one call: each draw of it reads its trees from a texture. */
import { LEVEL_COUNT } from "../detail";
import { FLAT_SHIFT } from "../nodes/flatTexture";

/** Draws per call: one per level of detail, and one for what only trees near the eye show. */
export const DRAWS_PER_CALL = LEVEL_COUNT + 1;
/** The last draw, of trees at the finest level. */
export const NEAR_DRAW = LEVEL_COUNT;

/** Declarations in place of the attributes of a tree. `gl_DrawID` is the draw of the call. */
export const TOGETHER_PARS = /* glsl */ `
uniform highp sampler2D uTrees; // three texels per tree
uniform int uTreesFrom[${DRAWS_PER_CALL}]; // first tree of each draw
vec4 aPlace;
vec4 aTurn;
vec4 aTint;
vec4 treeTexel(int i) {
  return texelFetch(uTrees, ivec2(i & ((1 << ${FLAT_SHIFT}) - 1), i >> ${FLAT_SHIFT}), 0);
}
#ifndef STILL
attribute vec4 aJoints0;  // at the finest level: the two nodes, share of the second / WHOLE_SHARE; the vertex
attribute vec4 aJoints12; // the two nodes at the next two levels
attribute vec4 aJoints34; // at the coarsest two
vec4 aJoint;
#endif
void takeTree() {
  int i = 3 * (uTreesFrom[gl_DrawID] + gl_InstanceID);
  aPlace = treeTexel(i);
  aTurn = treeTexel(i + 1);
  aTint = treeTexel(i + 2);
  #ifndef STILL
    aJoint = aJoints0;
    if (gl_DrawID == 1) aJoint.xy = aJoints12.xy;
    if (gl_DrawID == 2) aJoint.xy = aJoints12.zw;
    if (gl_DrawID == 3) aJoint.xy = aJoints34.xy;
    if (gl_DrawID == 4) aJoint.xy = aJoints34.zw;
    if (aJoint.x == aJoint.y) aJoint.z = 0.0;
  #endif
}
`;
