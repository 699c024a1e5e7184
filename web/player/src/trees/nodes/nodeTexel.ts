/** A texel of pass 1: displacement of a node (m), wind at the tree (m/s) and rotation vector of the node, as half floats. */

/** GLSL: texel of a flat index, and its contents. */
export const NODE_TEXEL = /* glsl */ `
uvec4 nodeTexel(highp usampler2D nodes, int index, int shift) {
  return texelFetch(nodes, ivec2(index & ((1 << shift) - 1), index >> shift), 0);
}
vec3 nodeMoved(uvec4 texel) {
  return vec3(unpackHalf2x16(texel.x), unpackHalf2x16(texel.y).x);
}
float nodeWind(uvec4 texel) {
  return unpackHalf2x16(texel.y).y;
}
vec3 nodeTurned(uvec4 texel) {
  return vec3(unpackHalf2x16(texel.z), unpackHalf2x16(texel.w).x);
}
`;

/**
 * GLSL: turns an arm by a rotation vector: half the curl of the displacement over the stretch of the link, which is the sine
 * of the angle. The sine that is drawn never exceeds 1.
 */
export const TURN_BY = /* glsl */ `
vec4 turnOf(vec3 curl) {
  float squared = dot(curl, curl);
  vec3 axis = curl * inversesqrt(sqrt(1.0 + squared * squared));
  return vec4(axis, sqrt(max(0.0, 1.0 - dot(axis, axis))));
}
vec3 turnedBy(vec4 turn, vec3 arm) {
  return turn.w * arm + cross(turn.xyz, arm) + turn.xyz * (dot(turn.xyz, arm) / (1.0 + turn.w));
}
`;
