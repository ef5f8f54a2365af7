// HBIL over the pixels. The bent cone is the bent normal and, in w, the cosine of its half aperture.
#version 460
#include "params/hbil"
#include "common/pack.glsl"
#include "gi/inputs.glsl"

FETCH_UINT_IMAGE(radiance);
#define FETCH_RADIANCE(texel) FETCH(radiance, texel)
uniform writeonly image2D visibility;
uniform writeonly image2D light;
uniform writeonly image2D bent;
uniform writeonly image2D ambient;
#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
#endif

#if HBIL_MIPS
uniform texture2D radiance_mips;  // from half the size on
#endif
const int RADIANCE_LEVELS = 6;  // beside the full one
vec3 radiance_level(ivec2 texel, int level) {
#if HBIL_MIPS
  int last = textureQueryLevels(radiance_mips);
  // One level after the other: a software device reads all of a group from the level of the first.
  for (int mip = 0; mip < RADIANCE_LEVELS; ++mip)
    if (mip + 1 == min(level, last))
      return texelFetch(radiance_mips, min(texel >> (mip + 1), textureSize(radiance_mips, mip) - 1), mip).rgb;
#endif
  return unpack_rgb9e5(FETCH_RADIANCE(texel));
}

vec3 environment_cone(vec3 direction, float cone, float ao);
#include "gi/hbil.glsl"

vec3 environment_cone(vec3 direction, float cone, float ao) {
  vec3 bands = cone_bands(cone);
  float factor = HBIL_FAR == FAR_FACTOR ? energy_factor(ao) : ao;
#ifdef ENVIRONMENT_MAP
  vec3 world = mat3(frame.world_from_view) * direction;
  if (HBIL_FAR != FAR_SH_CONE) return factor * environment_irradiance(world);
  Bands open = environment_bands(world);
  return max(bands.x * open.constant + bands.y * open.linear + bands.z * open.quadratic, 0.0f);
#else
  return frame.environment * (HBIL_FAR == FAR_SH_CONE ? bands.x : factor);
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  INSPECT_BEGIN(pixel);
  Lit lit = estimate_hbil(pixel);
  INSPECT_END(0, lit.visibility, lit.gi);
  imageStore(visibility, pixel, vec4(lit.visibility));
  imageStore(light, pixel, vec4(lit.gi, 1.0f));
  imageStore(bent, pixel, vec4(lit.bent, lit.cone));
  imageStore(ambient, pixel, vec4(lit.ambient, 1.0f));
}
