// Rays through the depth buffer, over the pixels.
#version 460
#include "params/raymarch"
#include "gi/inputs.glsl"

FETCH_UINT_IMAGE(radiance);
#define FETCH_RADIANCE(texel) FETCH(radiance, texel)
uniform writeonly image2D visibility;
uniform writeonly image2D light;
uniform writeonly image2D bent;
#if RAYMARCH_AMBIENT
uniform writeonly image2D ambient;
#define AMBIENT_SOURCE RAYMARCH_AMBIENT_SOURCE
#define AMBIENT_ROUGHNESS 0.4f
#include "gi/environment_from.glsl"
#else
vec3 environment_from(vec3 direction) { return vec3(0.0f); }
vec3 environment_over(vec3 normal) { return vec3(0.0f); }
#endif

#include "gi/raymarch.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  INSPECT_BEGIN(pixel);
  Gathered gathered = estimate_raymarch(pixel);
  INSPECT_END(-1, gathered.visibility, gathered.gi);
  imageStore(visibility, pixel, vec4(gathered.visibility));
  imageStore(light, pixel, vec4(gathered.gi, 1.0f));
  imageStore(bent, pixel, vec4(gathered.bent, 0.0f));
#if RAYMARCH_AMBIENT
  imageStore(ambient, pixel, vec4(gathered.ambient, 1.0f));
#endif
}
