// Final radiance = direct + ambient_out + indirect + emission; the background shows the environment.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/surface.glsl"
#include "common/view.glsl"
#include "common/ambient.glsl"

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
uniform texture2D albedo;
uniform texture2D material;
uniform texture2D emissive;
uniform texture2D direct_diffuse;
uniform texture2D direct_specular;
#ifdef HAS_GI
uniform texture2D gi;
#endif

layout(location = 0) out vec4 lit;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 ray = normalize(view_ray(vec2(pixel) + 0.5, frame.ray_scale, frame.ray_offset));
  if (FETCH(depth, pixel) <= 0.0) {
#ifdef ENVIRONMENT_MAP
    lit = vec4(environment_radiance(mat3(frame.world_from_view) * ray), 1.0);
#else
    lit = vec4(frame.environment, 1.0);
#endif
    return;
  }
  vec4 material_texel = texelFetch(material, pixel, 0);
  Surface s = unpack_surface(texelFetch(albedo, pixel, 0), material_texel);
  lit = vec4(0.0, 0.0, 0.0, 1.0);
  lit.rgb = texelFetch(direct_diffuse, pixel, 0).rgb + texelFetch(direct_specular, pixel, 0).rgb + texelFetch(emissive, pixel, 0).rgb +
            ambient_out(pixel, s, material_texel.b, material_texel.a, unpack_normal(FETCH(normal, pixel)), -ray);
#ifdef HAS_GI
  lit.rgb += diffuse_reflectance(s, material_texel.b) * texelFetch(gi, pixel, 0).rgb;
#endif
#ifdef ENVIRONMENT_MAP
  lit.rgb = min(lit.rgb, 65504.0);  // the sun in a mirror must not become infinite
#endif
}
