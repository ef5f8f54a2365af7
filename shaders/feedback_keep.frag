// What this frame's surfaces reflect diffusely of what the technique found, for the next frame; INCLUDE_AMBIENT: and of the
// environment. Alpha is the luminance of what the technique gathered from, for the loop's gain.
#version 460
#include "common/color.glsl"
#include "common/feedback.glsl"
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/surface.glsl"
#include "params/feedback"
#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
#endif

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(radiance);
uniform texture2D albedo;
uniform texture2D material;
uniform texture2D gi;
#ifdef INCLUDE_AMBIENT
#ifdef HAS_AMBIENT
uniform texture2D ambient;
#else
FETCH_UINT_IMAGE(normal);
#ifdef HAS_VISIBILITY
uniform texture2D visibility;
#endif
#endif
#endif
layout(location = 0) out vec4 reflected;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 material_texel = texelFetch(material, pixel, 0);
  Surface s = unpack_surface(texelFetch(albedo, pixel, 0), material_texel);
  vec3 light = texelFetch(gi, pixel, 0).rgb;
#ifdef INCLUDE_AMBIENT
#ifdef HAS_AMBIENT
  light += texelFetch(ambient, pixel, 0).rgb;
#else
#ifdef ENVIRONMENT_MAP
  vec3 sky = environment_irradiance(mat3(frame.world_from_view) * unpack_normal(FETCH(normal, pixel)));
#else
  vec3 sky = frame.environment;
#endif
#ifdef HAS_VISIBILITY
  sky *= texelFetch(visibility, pixel, 0).x;
#endif
  light += sky;
#endif
#endif
  vec3 out_light = limit_reflectance(diffuse_reflectance(s, material_texel.b), feedback.albedo_limit) * light;
  bool surface = FETCH(depth, pixel) > 0.0;
  reflected = surface ? vec4(is_number(out_light) ? clamp(out_light, 0.0, 65504.0) : vec3(0.0),
                             min(luminance(unpack_rgb9e5(FETCH(radiance, pixel))), 65504.0))
                      : vec4(0.0);
}
