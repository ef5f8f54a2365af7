// SSDO over the pixels.
#version 460
#include "params/ssdo"
#include "gi/inputs.glsl"

uniform writeonly image2D visibility;
uniform writeonly image2D bent;
#if SSDO_BOUNCE
FETCH_UINT_IMAGE(radiance);
uniform writeonly image2D light;
#define FETCH_RADIANCE(texel) FETCH(radiance, texel)
#else
#define FETCH_RADIANCE(texel) 0u
#endif
#if SSDO_AMBIENT
uniform writeonly image2D ambient;
#define AMBIENT_SOURCE SSDO_AMBIENT_SOURCE
#define AMBIENT_ROUGHNESS 0.4f
#include "gi/environment_from.glsl"
#else
vec3 environment_from(vec3 direction) { return vec3(0.0f); }
vec3 environment_over(vec3 normal) { return vec3(0.0f); }
#endif

#include "gi/ssdo.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  INSPECT_BEGIN(pixel);
  Gathered gathered = estimate_ssdo(pixel);
  INSPECT_END(-1, gathered.visibility, gathered.gi);
  imageStore(visibility, pixel, vec4(gathered.visibility));
  imageStore(bent, pixel, vec4(gathered.bent, 0.0f));
#if SSDO_BOUNCE
  imageStore(light, pixel, vec4(gathered.gi, 1.0f));
#endif
#if SSDO_AMBIENT
  imageStore(ambient, pixel, vec4(gathered.ambient, 1.0f));
#endif
}
