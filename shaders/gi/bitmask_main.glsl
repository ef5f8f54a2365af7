// The visibility-bitmask pass over the pixels; BITMASK_LIGHT as in gi/bitmask.glsl. `bitmask` is the technique's own block.
#include "gi/inputs.glsl"

uniform writeonly image2D visibility;
#if BITMASK_LIGHT
FETCH_UINT_IMAGE(radiance);  // what surfaces send out
uniform writeonly image2D light;
#define FETCH_RADIANCE(texel) FETCH(radiance, texel)
#endif
#if BITMASK_AMBIENT
uniform writeonly image2D bent;
uniform writeonly image2D ambient;
#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
const int SOURCE_SH = 0;
#endif

vec3 environment_from(vec3 direction) {
#ifdef ENVIRONMENT_MAP
  vec3 world = mat3(frame.world_from_view) * direction;
  if (BITMASK_AMBIENT_SOURCE == SOURCE_SH) return environment_smooth_radiance(world);
  // A lobe about as wide as a region.
  return environment_lobe(world, bitmask.regions > 6 ? 0.4f : bitmask.regions > 2 ? 0.6f : 0.9f);
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
#endif

#include "gi/bitmask.glsl"

void main() {
  ivec2 pixel = dispatch_pixel();
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  Estimate estimate = estimate_bitmask(pixel);
  imageStore(visibility, pixel, vec4(estimate.visibility));
#if BITMASK_LIGHT
  imageStore(light, pixel, vec4(estimate.gi, 1.0f));
#endif
#if BITMASK_AMBIENT
  imageStore(bent, pixel, vec4(estimate.bent, 0.0f));
  imageStore(ambient, pixel, vec4(estimate.ambient, 1.0f));
#endif
}
