/** Colour and cover of leaves before light falls on them: the picture on a card or spray, in GLSL. */
import { SHEET_ROWS, SHOOT_TILES_PER_SIDE } from "../treeModel/sprayTiles";

/**
 * The leaves of a spray move against each other: a field of displacements that differs from leaf to leaf bends its picture. It
 * vanishes at the edges of the picture's square tiles, which lie in rows and hold different sprays. Largest displacement
 * relative to a tile at a wind, m/s; in stronger wind it grows further, up to a factor.
 */
const SPRAY_SHIFT_TILES = 0.022;
const SPRAY_FULL_M_S = 9;
const SPRAY_MOST = 1.7;

export const SPRAY_MOTION = /* glsl */ `
vec2 sprayShift(vec2 at, vec4 piece, ivec2 size) {
  vec2 q = fract(${SHEET_ROWS.toFixed(1)} * at * vec2(size) / float(size.y));
  q *= 1.0 - q;
  float own = 6.2832 * fract(31.7 * piece.x);
  vec2 hz = uLeafHz * (vec2(0.55, 0.75) + 0.7 * fract(vec2(7.3, 11.9) * piece.x));
  vec2 turn = 6.2832 * (hz * uFlutter.x + vec2(9.0 * at.x + 5.0 * at.y, 8.0 * at.y - 6.0 * at.x)) + vec2(own, 1.7 * own);
  return ${(SPRAY_SHIFT_TILES / SHEET_ROWS).toFixed(4)} * min(${SPRAY_MOST.toFixed(1)}, piece.w / ${SPRAY_FULL_M_S.toFixed(1)}) * 16.0 * q.x * q.y * sin(turn);
}
`;

/**
 * Far away a tree has fewer and larger cards (detail.ts). So that its leaves keep their size, a card that has grown by more than this shows
 * four shoots of half its size, of all the tiles of the picture, in place of one.
 */
const COPIED_FROM = 1.3;

export const SHOOT_COPY = /* glsl */ `
vec2 shootCopy(vec2 at) {
  const float TILES = ${SHOOT_TILES_PER_SIDE.toFixed(1)};
  vec2 inTile = 2.0 * fract(TILES * at);
  return (mod(floor(TILES * at) + floor(inTile), TILES) + fract(inTile)) / TILES;
}
`;

/** Leaves are cut off below this alpha. */
export const ALPHA_TEST = 0.42;

/** From afar, a shoot covers as much as so many of its pictures would behind each other, of which each has its holes elsewhere. */
const LEAF_LAYERS = 1.6;
const NEEDLE_LAYERS = 2.2;

/** Interleaved gradient noise (Jimenez 2014): even over few pixels. */
export const GRADIENT_NOISE = /* glsl */ `
float gradientNoise(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}
`;

/** Cells of shoots with needles are longer than wide, along the shoot: streaks, where square ones would look like leaves. */
const NEEDLE_CELL_LENGTH = 4;

/**
 * Alpha of a leaf picture that is drawn smaller than it is, in texels per pixel: then it is the share of a pixel that leaves cover.
 * Cut off at a fixed value, a shoot of needles would be a solid blob from afar, as wide as the shoot. Instead, a pixel is covered with the
 * probability alpha, by a random number for each cell of the picture that is about as large as a pixel (hashed alpha testing: Wyman and
 * McGuire 2017), so that cards behind each other add up.
 */
export const LEAF_COVER = /* glsl */ `
${GRADIENT_NOISE}
#ifdef EVERGREEN
  const vec2 CELLS_PER_PIXEL = vec2(1.0, ${(1 / NEEDLE_CELL_LENGTH).toFixed(3)});
  const float FAR_LAYERS = ${NEEDLE_LAYERS.toFixed(1)};
#else
  const vec2 CELLS_PER_PIXEL = vec2(1.0);
  const float FAR_LAYERS = ${LEAF_LAYERS.toFixed(1)};
#endif
float leafCover(float alpha, vec2 texel, float wide, float piece) {
  float level = 0.5 * log2(max(wide, 1.0));
  float far = smoothstep(1.0, 2.5, level);
  if (far == 0.0) return alpha;
  vec2 cell = floor(texel * exp2(-ceil(level)) * CELLS_PER_PIXEL) + 59.0 * floor(97.0 * piece);
  float open = pow(1.0 - min(alpha, 1.0), FAR_LAYERS);
  float covered = clamp(${ALPHA_TEST} + 4.0 * (1.0 - open - gradientNoise(cell)), 0.0, 1.0);
  return mix(alpha, covered, far);
}
`;

export const LEAF_MAP = /* glsl */ `
#ifdef USE_MAP
  vec2 leafUv = vMapUv;
  float copies = 1.0;
  #ifdef SHOOT_TILES
    if (vPiece.z > ${COPIED_FROM.toFixed(2)} + 0.3 * fract(vPiece.x * 3.7)) {
      copies = 2.0;
      leafUv = shootCopy(vMapUv);
    }
  #endif
  #ifdef SPRAYS
    leafUv += sprayShift(vMapUv, vPiece, textureSize(map, 0));
  #endif
  vec2 texels = vec2(textureSize(map, 0));
  vec2 right = copies * dFdx(vMapUv);
  vec2 down = copies * dFdy(vMapUv);
  #ifdef CUTICLE
    vec4 leaf = textureGrad(map, leafUv, right, down);
  #endif
  right *= texels;
  down *= texels;
  #ifndef CUTICLE
    // the same without anisotropic filtering, for two thirds of the time that leaves cost where the processor draws
    vec4 leaf = textureLod(map, leafUv, 0.5 * log2(max(dot(right, right), dot(down, down))));
  #endif
  float area = abs(right.x * down.y - right.y * down.x) + 1e-4;
  float wide = 0.5 * (dot(right, right) + dot(down, down));
  #ifndef SINGLE_LEAVES
    leaf.a = leafCover(leaf.a, copies * vMapUv * texels, wide, vPiece.x);
    // A card seen edge-on is a smear of all its leaves, so fade it: 1 from the front, twice the cosine at the edge.
    leaf.a *= smoothstep(0.1, 0.5, area / wide);
  #endif
  diffuseColor *= leaf;
#endif
float shade = dot(diffuseColor.rgb, vec3(0.2126, 0.7152, 0.0722));
#ifdef USE_MAP
  // Each leaf of the picture keeps its deviation from the mean colour of all leaves, which is the coarsest mip level.
  vec3 mean = max(textureLod(map, vMapUv, 10.0).rgb, 0.01);
  // Green leaves differ in lightness more than in hue, coloured ones in both.
  #ifdef SINGLE_LEAVES
    const float MOST_HUES = 0.5; // petioles, which are seen here, would be red lines
  #else
    const float MOST_HUES = 0.9;
  #endif
  float hues = mix(0.3, MOST_HUES, smoothstep(0.0, 0.3, vTint.r - 0.6 * vTint.g));
  float picture = dot(leaf.rgb, vec3(0.2126, 0.7152, 0.0722));
  vec3 own = clamp(mix(vec3(shade / dot(mean, vec3(0.2126, 0.7152, 0.0722))), leaf.rgb / mean, hues), 0.45, 1.8);
#else
  vec3 own = vec3(0.35 + 1.9 * shade);
#endif
diffuseColor.rgb = mix(diffuseColor.rgb, 0.87 * vTint.rgb * mix(vec3(1.0), own, 0.85), vTint.a);
// Cards differ in lightness and hue: some yellower, some bluer.
diffuseColor.rgb *= 0.82 + 0.36 * vPiece.x;
diffuseColor.rgb *= mix(vec3(1.05, 1.01, 0.85), vec3(0.92, 1.02, 1.05), fract(vPiece.x * 7.31));
`;

/**
 * In strong wind leaves, other than those of evergreens, turn over and show their undersides, which scatter more light and have less
 * colour than the glossy side: crowns flash pale where a gust passes. Wind, m/s, at which the first leaves turn over, and at which the
 * most do; their largest share, and the lightness of the underside over that of the upper side (assumed). Distant crowns, whose pictures do not know the wind, stay as they
 * are, so that it fades between two distances, m. Leaves turn to and fro, at some hertz each, so that a crown glitters: a share
 * of them at any moment.
 */
const OVERTURNED_M_S = [7, 17] as const;
const MOST_OVERTURNED = 0.6;
const FLASHING_SHARE = 0.22;
const FLASHING_HZ = [0.9, 1.6] as const;
const UNDERSIDE_LIGHTNESS = 1.55;
const OVERTURNED_WITHIN_M = [22, 42] as const;

export const UNDERSIDES = /* glsl */ `
#ifndef EVERGREEN
float overturned = ${MOST_OVERTURNED} * smoothstep(${OVERTURNED_M_S[0].toFixed(1)}, ${OVERTURNED_M_S[1].toFixed(1)}, vPiece.w);
overturned *= 1.0 - smoothstep(${OVERTURNED_WITHIN_M[0].toFixed(1)}, ${OVERTURNED_WITHIN_M[1].toFixed(1)}, length(vViewPosition));
float flashHz = ${FLASHING_HZ[0]} + ${FLASHING_HZ[1]} * fract(vPiece.x * 17.9);
float flash = ${FLASHING_SHARE} * sin(6.2832 * (flashHz * uFlutter.x + vPiece.x * 23.0));
float under = overturned > 0.0 ? smoothstep(0.0, 0.25, overturned * (1.25 + flash) - fract(vPiece.x * 5.3)) : 0.0;
vec3 underside = ${UNDERSIDE_LIGHTNESS} * mix(diffuseColor.rgb, vec3(dot(diffuseColor.rgb, vec3(0.2126, 0.7152, 0.0722))), 0.4);
diffuseColor.rgb = mix(diffuseColor.rgb, underside, under);
#endif
`;
