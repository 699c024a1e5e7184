/**
 * Shader code of pass 1, which has two steps. The first adds up the displacements of the nodes. The second shortens the links
 * between them that have become too long (core/motion/nodePose.ts), and adds the rotations, without that stretch, and the wind.
 */
import { LONGEST_LINK, MOST_LINK_STRETCH } from "../../core/constants";

export const COVER_GLSL = /* glsl */ `
in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }
`;

/** Most links between a node and the ground. */
export const MOST_LINKS = 64;

const PARS_GLSL = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D uRows;
uniform sampler2D uPoses;
#ifdef BLEND
uniform sampler2D uBefore;
uniform float uShare;
#endif
uniform float uFactor;
uniform int uNodeCount;
uniform int uShift;
uniform int uRow;
uniform int uDrawn;
layout(location = 0) out uvec4 texel;

vec4 flat_(sampler2D source, int i) {
  return texelFetch(source, ivec2(i & ((1 << FLAT_SHIFT) - 1), i >> FLAT_SHIFT), 0);
}
/** Sum of three rows of a node over the coordinates of its tree, and the last of these, which hold the wind. */
vec3 summed(int slot, int row, out vec4 q) {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < QUADS; k++) {
    int i = slot * QUADS + k;
    q = flat_(uPoses, i);
    #ifdef BLEND
      vec4 before = flat_(uBefore, i);
      q = before + (q - before) * uShare;
    #endif
    sum.x += dot(q, flat_(uRows, row + k));
    sum.y += dot(q, flat_(uRows, row + QUADS + k));
    sum.z += dot(q, flat_(uRows, row + 2 * QUADS + k));
  }
  return uFactor * sum;
}
`;

/** Index of the texel in its level, of its tree and of its node. */
const PLACE_GLSL = /* glsl */ `
  ivec2 at = ivec2(gl_FragCoord.xy);
  int i = ((at.y - uRow) << uShift) + at.x;
  int slot = i / uNodeCount;
  if (slot >= uDrawn) discard;
  int node = i - slot * uNodeCount;
`;

export const DISPLACE_GLSL = /* glsl */ `${PARS_GLSL}
void main() {
  ${PLACE_GLSL}
  vec4 q;
  vec3 moved = summed(slot, node * 3 * QUADS, q);
  texel = uvec4(floatBitsToUint(moved), floatBitsToUint(q[WIND_CHANNEL]));
}
`;

/**
 * The rest of the second step, for a node: `curl` is the sum of its rotations, `movedAt(tree + node)` the displacement of a node of its
 * tree, and `q` the last coordinates.
 */
export const SHORTEN_LINKS_GLSL = /* glsl */ `
  vec3 moved = movedAt(tree + node);
  vec3 excess = vec3(0.0);
  vec3 own = moved;
  for (int k = 0; k < ${MOST_LINKS}; k++) {
    vec4 link = flat_(uLinks, node);
    int before = int(link.w + 0.5);
    if (before == node) break;
    vec3 limb = movedAt(tree + before);
    vec3 now = link.xyz + own - limb;
    float rest = length(link.xyz);
    float span = length(now);
    if (k == 0) curl /= clamp(span / max(rest, 1e-9), 1.0, ${MOST_LINK_STRETCH.toFixed(1)});
    excess += now * max(0.0, 1.0 - ${LONGEST_LINK} * rest / max(span, 1e-9));
    own = limb;
    node = before;
  }
  moved -= excess;
  texel = uvec4(packHalf2x16(moved.xy), packHalf2x16(vec2(moved.z, q[WIND_CHANNEL])),
    packHalf2x16(curl.xy), packHalf2x16(vec2(curl.z, 0.0)));
`;

export const SHORTEN_GLSL = /* glsl */ `${PARS_GLSL}
uniform usampler2D uMoved;
uniform sampler2D uLinks; // per node: vector from the node before it at rest, and the index of that
vec3 movedAt(int i) {
  return uintBitsToFloat(texelFetch(uMoved, ivec2(i & ((1 << uShift) - 1), uRow + (i >> uShift)), 0).xyz);
}
void main() {
  ${PLACE_GLSL}
  vec4 q;
  vec3 curl = summed(slot, node * 3 * QUADS, q);
  int tree = slot * uNodeCount;
  ${SHORTEN_LINKS_GLSL}}
`;
