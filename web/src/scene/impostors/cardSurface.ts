/** Colour and light of an impostor; the same as those of the trees' own shader, for leaves and wood in one picture. */

export const FLAT_VARYINGS = /* glsl */ `
flat varying vec4 vCorner;
flat varying vec4 vTint;
flat varying vec2 vLook; // opacity, random number
flat varying vec2 vTurn; // cosine and sine of the yaw
flat varying vec3 vSunward;
`;

/** Colour of the season: leaves take the tint of their tree, wood keeps its own; snow on what faces the sky. */
export const SURFACE = /* glsl */ `
vec3 own = seen.colour.rgb * seen.colour.rgb;
float shade = dot(own, vec3(0.2126, 0.7152, 0.0722));
own = mix(own, mix(own, vTint.rgb * (0.35 + 1.9 * shade), vTint.a), leafy);
float open = 2.5 * (seen.surface.w - (leafy > 0.5 ? 0.6 : 0.0));
vec3 ownNormal = fromOctahedron(2.0 * seen.surface.xy - 1.0);
vec3 worldNormal = vec3(vTurn.x * ownNormal.x + vTurn.y * ownNormal.z, ownNormal.y, vTurn.x * ownNormal.z - vTurn.y * ownNormal.x);
own = mix(own, uSnowColour, smoothstep(0.05, 0.5, worldNormal.y + 0.35 * (noise - 0.6)) * uSnow);
diffuseColor.rgb = own;
diffuseColor.a = 1.0;
`;

export const NORMAL = /* glsl */ `
vec3 normal = normalize((viewMatrix * vec4(worldNormal, 0.0)).xyz);
vec3 nonPerturbedNormal = normal;
`;

/** As the trees' LEAF_LIGHT and WOOD_LIGHT; the crown shades itself along the way of the sunlight through it. */
export const LIGHT = /* glsl */ `
#include <lights_fragment_end>
{
  float inside = dot(seen.at, vSunward);
  float out_ = inside * inside - dot(seen.at, seen.at) + 0.6;
  float way = out_ > 0.0 ? max(0.0, sqrt(out_) - inside) : 0.0;
  float reached = 0.22 + 0.78 * exp(-1.1 * way * way);
  // Among other trees, less light reaches the lower part.
  float clearance = mix(1.0, smoothstep(-0.25, 0.75, vHeight), uCrowded);
  reflectedLight.directDiffuse *= reached * clearance;
  reflectedLight.indirectDiffuse *= 0.55 + 0.45 * clearance;
  reflectedLight.indirectDiffuse *= mix(0.35 + 0.65 * open, 0.3 + 0.7 * open, leafy);
  reflectedLight.directDiffuse *= mix(1.0, 0.5 + 0.5 * open, leafy);
  float through = pow(saturate(dot(-geometryViewDir, directLight.direction)), 3.0);
  float behind = saturate(0.45 - 0.55 * dot(geometryNormal, directLight.direction));
  reflectedLight.directDiffuse += leafy * reached * clearance * directLight.color * diffuseColor.rgb * open
    * (0.55 * through + 0.34 * behind) * vec3(1.05, 1.0, 0.62) * RECIPROCAL_PI;
}
`;
