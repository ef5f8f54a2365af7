// The environment for techniques that gather it by direction, in view space: its radiance from a direction, by spherical harmonics
// (AMBIENT_SOURCE 0) or from the prefiltered cube at a lobe of AMBIENT_ROUGHNESS; and irradiance / pi over the open hemisphere.
#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
#endif

vec3 environment_from(vec3 direction) {
#ifdef ENVIRONMENT_MAP
  vec3 world = mat3(frame.world_from_view) * direction;
  return AMBIENT_SOURCE == 0 ? environment_smooth_radiance(world) : environment_lobe(world, AMBIENT_ROUGHNESS);
#else
  return frame.environment;
#endif
}

vec3 environment_over(vec3 normal) {
#ifdef ENVIRONMENT_MAP
  return environment_irradiance(mat3(frame.world_from_view) * normal);
#else
  return frame.environment;
#endif
}
