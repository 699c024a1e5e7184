/** Value noise for shaders, on integer hashes: the same on every graphics driver. */
export const NOISE_GLSL = /* glsl */ `
float hashAt(ivec2 p) {
  uint h = uint(p.x) * 0x9e3779b1u ^ uint(p.y) * 0x85ebca6bu;
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return float((h ^ (h >> 16)) >> 8) / 16777216.0;
}
float noiseAt(vec2 p) {
  ivec2 i = ivec2(floor(p));
  vec2 f = p - vec2(i);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(hashAt(i), hashAt(i + ivec2(1, 0)), f.x),
             mix(hashAt(i + ivec2(0, 1)), hashAt(i + ivec2(1, 1)), f.x), f.y);
}
float fractalAt(vec2 p) {
  float sum = 0.0;
  float share = 0.5;
  for (int k = 0; k < 5; k++) {
    sum += share * noiseAt(p);
    p = mat2(1.6, 1.2, -1.2, 1.6) * p + 7.3;
    share *= 0.5;
  }
  return sum;
}
`;
