/** Shader code for pulled trees: displacement of each vertex, beyond its node's, per force on the pulled point. */
import { FLAT_SHIFT } from "../nodes/flatTexture";

/** Most pulls of one species that are drawn at once. */
export const MOST_PULLS = 4;

/** Declarations for the vertex shader. Without pulls the loop ends at once, for all vertices alike. */
export const PULL_PARS = /* glsl */ `
uniform int uPulls;
uniform vec4 uPullPlace[${MOST_PULLS}]; // x, z of the tree; first texel of the displacements
uniform vec3 uPullForce[${MOST_PULLS}]; // N, in the tree's frame at scale 1
uniform int uPullFirst; // index of this part's first vertex; negative: a part that is added to those of the file
uniform highp sampler2D uPullField; // three texels per vertex: displacement per force along x, y, z
vec3 pullTexel(int i) {
  return texelFetch(uPullField, ivec2(i & ((1 << ${FLAT_SHIFT}) - 1), i >> ${FLAT_SHIFT}), 0).xyz;
}
vec3 pulledBy() {
  vec3 moved = vec3(0.0);
  for (int k = 0; k < ${MOST_PULLS}; k++) {
    if (k >= uPulls) break;
    vec2 apart = abs(aPlace.xz - uPullPlace[k].xy);
    if (max(apart.x, apart.y) > 0.01) continue;
    int held = uPullFirst < 0 ? int(aJoint.w + 0.5) : uPullFirst + gl_VertexID;
    int i = int(uPullPlace[k].z + 0.5) + 3 * held;
    vec3 force = uPullForce[k];
    moved += force.x * pullTexel(i) + force.y * pullTexel(i + 1) + force.z * pullTexel(i + 2);
  }
  return moved;
}
`;
