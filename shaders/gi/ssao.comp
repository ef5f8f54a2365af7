// SSAO with colour bleeding over the pixels.
#version 460
#include "params/ssao"
#include "gi/inputs.glsl"

uniform writeonly image2D visibility;
#if SSAO_BLEED
FETCH_UINT_IMAGE(radiance);
uniform writeonly image2D light;
#define FETCH_RADIANCE(texel) FETCH(radiance, texel)
#else
#define FETCH_RADIANCE(texel) 0u
#endif

// What the environment adds to a sender's light where `ambient_share` asks for it, as if it were open.
#ifdef AMBIENT_BLEED
#include "common/surface.glsl"
#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
#endif
uniform texture2D albedo;
uniform texture2D material;
vec3 ambient_of(ivec2 texel) {
#ifdef ENVIRONMENT_MAP
  vec3 arriving = environment_irradiance(mat3(frame.world_from_view) * unpack_normal(FETCH_NORMAL(texel)));
#else
  vec3 arriving = frame.environment;
#endif
  vec4 material_texel = texelFetch(material, texel, 0);
  Surface surface = unpack_surface(texelFetch(albedo, texel, 0), material_texel);
  return ssao.ambient_share * diffuse_reflectance(surface, material_texel.b) * arriving;
}
#else
vec3 ambient_of(ivec2 texel) { return vec3(0.0f); }
#endif

#include "gi/ssao.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  INSPECT_BEGIN(pixel);
  Gathered gathered = estimate_ssao(pixel);
  INSPECT_END(-1, gathered.visibility, gathered.gi);
  imageStore(visibility, pixel, vec4(gathered.visibility));
#if SSAO_BLEED
  imageStore(light, pixel, vec4(gathered.gi, 1.0f));
#endif
}
