// Final radiance = direct + ambient_out + indirect + emission; the background shows the environment.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/surface.glsl"

FETCH_FLOAT_IMAGE(depth);
uniform texture2D albedo;
uniform texture2D material;
uniform texture2D emissive;
uniform texture2D direct_diffuse;
uniform texture2D direct_specular;
#ifdef HAS_GI
uniform texture2D gi;
#endif
#ifdef HAS_VISIBILITY
uniform texture2D visibility;
#endif

layout(location = 0) out vec4 lit;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  lit = vec4(frame.environment, 1.0);
  if (FETCH(depth, pixel) <= 0.0) return;
  vec4 material_texel = texelFetch(material, pixel, 0);
  Surface s = unpack_surface(texelFetch(albedo, pixel, 0), material_texel);
  vec3 gathered = frame.environment;  // irradiance / pi of a constant environment, unoccluded
#ifdef HAS_VISIBILITY
  gathered *= texelFetch(visibility, pixel, 0).x;
#endif
#ifdef HAS_GI
  gathered += texelFetch(gi, pixel, 0).rgb;
#endif
  lit.rgb = texelFetch(direct_diffuse, pixel, 0).rgb + texelFetch(direct_specular, pixel, 0).rgb + texelFetch(emissive, pixel, 0).rgb +
            diffuse_reflectance(s, material_texel.b) * gathered;
}
