/** Shader code of pass 1 that draws all levels of all species with one call (togetherNodes.ts); per level the same as nodes/levelShader.ts. */
import { FLAT_SHIFT } from "../nodes/flatTexture";
import { SHORTEN_LINKS_GLSL } from "../nodes/levelShader";

/** Each instance is the rectangle of a level in the target; one without trees is empty. */
export const LEVEL_RECTANGLES_GLSL = /* glsl */ `
precision highp int;
in vec3 position; // corner of the rectangle
in ivec4 aPlace; // first row of the target; trees; nodes of each; nodes of the levels before
in ivec4 aSizes; // quads of coordinates; channel of the wind in the last; first texel of the poses; first texel of the rows
in float aShare; // of the newest poses
uniform int uShift;
uniform float uHeight;
flat out ivec4 place;
flat out ivec4 sizes;
flat out float share;
void main() {
  place = aPlace;
  sizes = aSizes;
  share = aShare;
  int rows = (aPlace.y * aPlace.z + (1 << uShift) - 1) >> uShift;
  float row = float(aPlace.x) + position.y * float(rows);
  gl_Position = vec4(2.0 * vec2(position.x, row / uHeight) - 1.0, 0.0, 1.0);
}
`;

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
flat in ivec4 place;
flat in ivec4 sizes;
flat in float share;
layout(location = 0) out uvec4 texel;

vec4 flat_(sampler2D source, int i) {
  return texelFetch(source, ivec2(i & ((1 << ${FLAT_SHIFT}) - 1), i >> ${FLAT_SHIFT}), 0);
}
/** Sum of the three rows of a node over the coordinates of its tree, and the last of these, which hold the wind. */
vec3 summed(int slot, int node, out vec4 q) {
  int quads = sizes.x;
  int row = sizes.w + node * 3 * quads;
  int pose = sizes.z + slot * quads;
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

/** Index of the texel in its level, of its tree and of its node. */
const PLACE_GLSL = /* glsl */ `
  ivec2 at = ivec2(gl_FragCoord.xy);
  int i = ((at.y - place.x) << uShift) + at.x;
  int slot = i / place.z;
  if (slot >= place.y) discard;
  int node = i - slot * place.z;
`;

export const DISPLACE_ALL_GLSL = /* glsl */ `${PARS_GLSL}
void main() {
  ${PLACE_GLSL}
  vec4 q;
  vec3 moved = summed(slot, node, q);
  texel = uvec4(floatBitsToUint(moved), floatBitsToUint(q[sizes.y]));
}
`;

export const SHORTEN_ALL_GLSL = /* glsl */ `${PARS_GLSL}
uniform usampler2D uMoved;
uniform sampler2D uLinks;
#define WIND_CHANNEL sizes.y
vec3 movedAt(int i) {
  return uintBitsToFloat(texelFetch(uMoved, ivec2(i & ((1 << uShift) - 1), place.x + (i >> uShift)), 0).xyz);
}
void main() {
  ${PLACE_GLSL}
  vec4 q;
  vec3 curl = summed(slot, node, q);
  node += place.w; // from here on counted over all levels, as in uLinks
  int tree = slot * place.z - place.w;
  ${SHORTEN_LINKS_GLSL}}
`;
