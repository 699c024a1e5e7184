/** Shader code of pass 1 that draws all levels of detail with one call (togetherNodes.ts); per level the same as nodes/levelShader.ts. */
import { LEVEL_COUNT } from "../detail";
import { FLAT_SHIFT } from "../nodes/flatTexture";
import { SHORTEN_LINKS_GLSL } from "../nodes/levelShader";

const PARS_GLSL = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D uRows;
uniform sampler2D uPoses;
uniform sampler2D uBefore;
uniform float uFactor;
uniform int uShift;
uniform ivec4 uSizes[${LEVEL_COUNT}]; // nodes; quads of coordinates; channel of the wind in the last; nodes of the levels before
uniform ivec4 uPlaces[${LEVEL_COUNT}]; // first row of the target; trees; first texel of the poses; first texel of the rows
uniform float uShares[${LEVEL_COUNT}]; // of the newest poses
layout(location = 0) out uvec4 texel;

vec4 flat_(sampler2D source, int i) {
  return texelFetch(source, ivec2(i & ((1 << ${FLAT_SHIFT}) - 1), i >> ${FLAT_SHIFT}), 0);
}
/** Sum of the three rows of a node over the coordinates of its tree, and the last of these, which hold the wind. */
vec3 summed(int level, int slot, int node, out vec4 q) {
  int quads = uSizes[level].y;
  int row = uPlaces[level].w + node * 3 * quads;
  int pose = uPlaces[level].z + slot * quads;
  float share = uShares[level];
  vec3 sum = vec3(0.0);
  for (int k = 0; k < quads; k++) {
    q = flat_(uPoses, pose + k);
    if (share < 1.0) {
      vec4 before = flat_(uBefore, pose + k);
      q = before + (q - before) * share;
    }
    sum.x += dot(q, flat_(uRows, row + k));
    sum.y += dot(q, flat_(uRows, row + quads + k));
    sum.z += dot(q, flat_(uRows, row + 2 * quads + k));
  }
  return uFactor * sum;
}
`;

/** Level of the texel, its index there, its tree and its node. */
const PLACE_GLSL = /* glsl */ `
  ivec2 at = ivec2(gl_FragCoord.xy);
  int level = 0;
  for (int k = 1; k < ${LEVEL_COUNT}; k++) if (uPlaces[k].y > 0 && at.y >= uPlaces[k].x) level = k;
  int firstRow = uPlaces[level].x;
  int nodeCount = uSizes[level].x;
  int i = ((at.y - firstRow) << uShift) + at.x;
  int slot = i / nodeCount;
  if (slot >= uPlaces[level].y) discard;
  int node = i - slot * nodeCount;
`;

export const DISPLACE_ALL_GLSL = /* glsl */ `${PARS_GLSL}
void main() {
  ${PLACE_GLSL}
  vec4 q;
  vec3 moved = summed(level, slot, node, q);
  texel = uvec4(floatBitsToUint(moved), floatBitsToUint(q[uSizes[level].z]));
}
`;

export const SHORTEN_ALL_GLSL = /* glsl */ `${PARS_GLSL}
uniform usampler2D uMoved;
uniform sampler2D uLinks;
#define WIND_CHANNEL uSizes[level].z
#define movedAt(i) movedIn(firstRow, i)
vec3 movedIn(int firstRow, int i) {
  return uintBitsToFloat(texelFetch(uMoved, ivec2(i & ((1 << uShift) - 1), firstRow + (i >> uShift)), 0).xyz);
}
void main() {
  ${PLACE_GLSL}
  vec4 q;
  vec3 curl = summed(level, slot, node, q);
  node += uSizes[level].w; // from here on counted over all levels, as in uLinks
  int tree = slot * nodeCount - uSizes[level].w;
  ${SHORTEN_LINKS_GLSL}}
`;
