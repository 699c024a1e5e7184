/** Shaders that draw one view of a tree at rest, and that reduce it to its place in the atlas. */

import { VARIANT_SHADER } from "galewood/trees";
import { GRADIENT_NOISE } from "../../treeSurface/leafColour";
import { COLOUR_STEPS } from "./atlasLayout";

/** Light is stored as its square root, which keeps dark colours apart in few bits. */
export const BAKE_VERTEX = /* glsl */ `
precision highp float;
in vec3 position;
in vec3 normal;
in vec2 uv;
in vec4 aPiece;
in vec4 aAnchor;
uniform vec3 uRight;
uniform vec3 uUp;
uniform vec3 uTowards;
uniform vec3 uPerMetre;
uniform float uMiddle;
out vec2 vUv;
out vec3 vNormal;
out vec4 vPiece;
out float vDepth;
${VARIANT_SHADER}
void main() {
  vec3 at = (position - vec3(0.0, uMiddle, 0.0)) * uPerMetre;
  vDepth = dot(at, uTowards);
  vUv = uv;
  vNormal = normal;
  vPiece = aPiece;
  gl_Position = vec4(dot(at, uRight), dot(at, uUp), -vDepth, 1.0);
  // As dense as the trees, each of which lacks some limbs.
  gl_Position = mix(vec4(2.0, 2.0, 2.0, 1.0), gl_Position, hasVariant(aAnchor.w, vec2(0.0)));
}
`;

export const BAKE_FRAGMENT = /* glsl */ `
precision highp float;
in vec2 vUv;
in vec3 vNormal;
in vec4 vPiece;
in float vDepth;
uniform sampler2D uMap;
uniform bool uMapped;
uniform vec3 uColour;
uniform float uCut;
uniform bool uLeaves;
layout(location = 0) out vec4 colour;
layout(location = 1) out vec4 surface;
vec2 octahedron(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 folded = (1.0 - abs(n.zx)) * vec2(n.z < 0.0 ? -1.0 : 1.0, n.x < 0.0 ? -1.0 : 1.0);
  return n.y < 0.0 ? folded : n.zx;
}
void main() {
  vec4 own = uMapped ? texture(uMap, vUv) : vec4(1.0);
  if (own.a < uCut) discard;
  vec3 light = own.rgb * uColour;
  if (uLeaves) {
    light *= 0.82 + 0.36 * vPiece.x;
    light *= mix(vec3(1.09, 1.01, 0.8), vec3(0.92, 1.02, 1.05), fract(vPiece.x * 7.31));
  } else {
    light *= (0.85 + 0.3 * vPiece.x) * (1.0 - 0.5 * light.g);
  }
  vec3 facing = normalize(vNormal);
  if (!uLeaves && !gl_FrontFacing) facing = -facing;
  colour = vec4(sqrt(clamp(light, 0.0, 1.0)), 1.0);
  surface = vec4(0.5 + 0.5 * octahedron(facing), 0.5 + 0.5 * vDepth, 0.4 * clamp(vPiece.y, 0.0, 1.0) + (uLeaves ? 0.6 : 0.0));
}
`;

export const REDUCE_VERTEX = /* glsl */ `
precision highp float;
in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }
`;

/**
 * Means over blocks of pixels. Colours are weighted by coverage and stay multiplied by it, so that nothing bleeds in from the
 * background; the surface of empty blocks is that of a ball, which suits the pixels next to them.
 */
export const REDUCE_FRAGMENT = /* glsl */ `
precision highp float;
precision highp int;
uniform sampler2D uColour;
uniform sampler2D uSurface;
uniform ivec2 uFrom;
uniform ivec2 uBlock;
uniform bool uOfSurface;
uniform vec3 uRight;
uniform vec3 uUp;
uniform vec3 uTowards;
uniform vec2 uSize;
out vec4 mean;
${GRADIENT_NOISE}
vec2 octahedron(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 folded = (1.0 - abs(n.zx)) * vec2(n.z < 0.0 ? -1.0 : 1.0, n.x < 0.0 ? -1.0 : 1.0);
  return n.y < 0.0 ? folded : n.zx;
}
/** How far a place lies behind the leaves around it: in the gaps between tufts, less light arrives. 0 to 1. */
float hollowness(ivec2 at, float depth) {
  ivec2 size = textureSize(uColour, 0);
  int stride = max(1, size.x / 48);
  float ahead = 0.0;
  for (int y = -2; y <= 2; y++) {
    for (int x = -2; x <= 2; x++) {
      ivec2 place = clamp(at + stride * ivec2(x, y), ivec2(0), size - 1);
      if (texelFetch(uColour, place, 0).a < 0.5) continue;
      ahead += clamp(texelFetch(uSurface, place, 0).z - depth - 0.004, -0.02, 0.06);
    }
  }
  return clamp(ahead * 1.33, 0.0, 1.0);
}
void main() {
  ivec2 first = (ivec2(gl_FragCoord.xy) - uFrom) * uBlock;
  vec4 sum = vec4(0.0);
  float depth = 0.0;
  float covered = 0.0;
  for (int y = 0; y < uBlock.y; y++) {
    for (int x = 0; x < uBlock.x; x++) {
      vec4 colour = texelFetch(uColour, first + ivec2(x, y), 0);
      if (colour.a < 0.5) continue;
      covered += 1.0;
      depth += texelFetch(uSurface, first + ivec2(x, y), 0).z;
      sum += uOfSurface ? texelFetch(uSurface, first + ivec2(x, y), 0) : vec4(colour.rgb * colour.rgb, 1.0);
    }
  }
  float hollow = covered > 0.0 ? hollowness(first + uBlock / 2, depth / covered) : 0.0;
  if (uOfSurface) {
    if (covered > 0.0) {
      sum /= covered;
      float kind = sum.w < 0.5 ? 0.0 : 0.6; // wood, leaves
      sum.w = kind + clamp((sum.w - kind) * (1.0 - 0.75 * hollow), 0.0, 0.4);
    }
    vec2 at = 2.0 * (gl_FragCoord.xy - vec2(uFrom)) / uSize - 1.0;
    vec3 ball = at.x * uRight + at.y * uUp + 0.5 * uTowards;
    // Beside thin parts, most of which are near the axis: the upright plane through it.
    float axis = at.y * uTowards.y / max(0.25, length(uTowards.xz));
    mean = covered > 0.0 ? sum : vec4(0.5 + 0.5 * octahedron(normalize(ball)), 0.5 + 0.5 * clamp(axis, -0.8, 0.8), 0.92);
  } else {
    float share = covered / float(uBlock.x * uBlock.y);
    vec3 light = covered > 0.0 ? sqrt(sum.rgb / covered * (1.0 - 0.55 * hollow)) * share : vec3(0.0);
    float chance = gradientNoise(gl_FragCoord.xy);
    mean = covered > 0.0 ? clamp(vec4(light, share) + (chance - 0.5) / ${COLOUR_STEPS.toFixed(1)}, 0.0, 1.0) : vec4(0.0);
  }
}
`;
