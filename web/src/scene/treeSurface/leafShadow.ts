/** Shadows on leaves at low quality. */

/**
 * GLSL after three.js's `shadowmap_pars_fragment`. At low quality, which does not define CUTICLE, leaves sample the shadow map once: three.js
 * samples it five times in each cascade, and among leaves, whose shadows are small, the difference is hard to see.
 */
export const ONE_SHADOW_SAMPLE = /* glsl */ `
#if defined(USE_SHADOWMAP) && NUM_SUN_LIGHT_SHADOWS > 0 && !defined(CUTICLE)
float sampledOnce(sampler2DShadow map, SunLightShadow light, int sun) {
  int cascade = sun * SUN_LIGHT_CASCADES;
  if (vSunShadowWorldPosition.w >= sunShadowCascade[cascade].y) cascade++;
  vec3 lifted = vSunShadowWorldPosition.xyz + light.shadowNormalBias * vSunShadowWorldNormal;
  vec3 at = (sunShadowMatrix[cascade] * vec4(lifted, 1.0)).xyz;
  at.z += light.shadowBias;
  bool within = all(lessThanEqual(abs(at - 0.5), vec3(0.5))) && vSunShadowWorldPosition.w < sunShadowCascade[cascade].y;
  return within ? mix(1.0, texture(map, at), light.shadowIntensity) : 1.0;
}
#define getSunShadow(map, light, sun) sampledOnce(map, light, sun)
#endif
`;
