/** Colour and light of an impostor; the same as those of the trees' own shader, for leaves and wood in one picture. */
import { snowOnNeedles } from "../treeSurface/treeLight";

export const FLAT_VARYINGS = /* glsl */ `
flat varying vec4 vCorner;
flat varying vec4 vTint;
flat varying vec2 vLook; // opacity, random number
flat varying vec2 vTurn; // cosine and sine of the yaw
flat varying vec3 vSunward;
flat varying vec4 vMean; // mean colour of the leaves' picture; 0 without one
`;

/** Colour of the season: leaves take the tint of their tree, wood keeps its own; snow on what faces the sky. */
export const SURFACE_GLSL = /* glsl */ `
vec3 own = seen.colour.rgb * seen.colour.rgb;
float shade = dot(own, vec3(0.2126, 0.7152, 0.0722));
// Each leaf keeps its deviation from the mean colour, as in the trees' LEAF_MAP.
float hues = mix(0.3, 0.9, smoothstep(0.0, 0.3, vTint.r - 0.6 * vTint.g));
vec3 deviation = clamp(mix(vec3(shade / dot(vMean.rgb, vec3(0.2126, 0.7152, 0.0722))), own / vMean.rgb, hues), 0.2, 1.8);
deviation = mix(vec3(0.35 + 1.9 * shade), mix(vec3(1.0), deviation, 0.85), vMean.a);
own = mix(own, mix(own, 0.87 * vTint.rgb * deviation, vTint.a), leafy);
float open = 2.5 * (seen.surface.w - (leafy > 0.5 ? 0.6 : 0.0));
vec3 ownNormal = fromOctahedron(2.0 * seen.surface.xy - 1.0);
vec3 worldNormal = vec3(vTurn.x * ownNormal.x + vTurn.y * ownNormal.z, ownNormal.y, vTurn.x * ownNormal.z - vTurn.y * ownNormal.x);
// Of a twig thinner than a pixel, the upper side is only a part.
float lying = leafy > 0.5
  ? ${snowOnNeedles("worldNormal.y", "noise")}
  : 0.62 * smoothstep(0.25, 0.8, worldNormal.y + 0.5 * (noise - 0.6));
own = mix(own, uSnowColour, lying * uSnow);
diffuseColor.rgb = own;
diffuseColor.a = 1.0;
`;

export const NORMAL_GLSL = /* glsl */ `
vec3 normal = normalize((viewMatrix * vec4(worldNormal, 0.0)).xyz);
vec3 nonPerturbedNormal = normal;
`;

/** As the trees' LEAF_LIGHT and WOOD_LIGHT; the crown shades itself along the way of the sunlight through it. */
export const LIGHT_GLSL = /* glsl */ `
#include <lights_fragment_end>
{
  float inside = dot(seen.at, vSunward);
  float left = inside * inside - dot(seen.at, seen.at) + 0.6;
  float way = left > 0.0 ? max(0.0, sqrt(left) - inside) : 0.0;
  float reached = 0.3 + 0.7 * exp(-1.1 * way * way);
  // Among other trees, less light reaches the lower part.
  float clearance = mix(1.0, smoothstep(-0.25, 0.75, vHeight), uCrowded);
  float facingSun = dot(geometryNormal, directLight.direction);
  vec3 colour = diffuseColor.rgb * RECIPROCAL_PI;
  vec3 skyward_ = (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz;
  reflectedLight.directDiffuse *= reached * clearance * mix(1.0, 0.6 + 0.4 * open, leafy);
  reflectedLight.indirectDiffuse *= mix(crownSky(open) * stemSky(1.0 - uBare, facingSun), leafSky(open), leafy);
  reflectedLight.indirectDiffuse += colour * mix(0.7, 1.0, leafy) * crownGlow(uSunColour, open, facingSun);
  reflectedLight.indirectDiffuse *= (0.6 + 0.4 * clearance) * (0.45 + 0.55 * min(1.0, 1.3 * open));
  float through = pow(saturate(dot(-geometryViewDir, directLight.direction)), 3.0);
  float behind = saturate(0.45 - 0.55 * facingSun);
  float beneath = saturate(0.2 - 0.8 * dot(geometryViewDir, skyward_));
  vec3 passed = mix(uSunColour, directLight.color, 0.78) * reached * clearance * (0.35 + 0.65 * open)
    * (0.6 * through + 0.34 * behind) + uSkyColour * leafSky(open) * 0.7 * beneath;
  reflectedLight.directDiffuse += leafy * colour * passed * passedColour(diffuseColor.rgb);
}
`;
