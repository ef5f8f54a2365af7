// One output layer (AOV) as floats, decoded from wherever it lives. World space; AOV_<NAME> chooses the layer.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/surface.glsl"
#include "common/view.glsl"
#include "common/ambient.glsl"

layout(location = 0) out vec4 value;

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
FETCH_UINT_IMAGE(radiance);
uniform texture2D albedo;
uniform texture2D material;
uniform texture2D source;   // AOV_COPY: whatever is shown as it is
uniform texture2D source2;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  value = vec4(0.0);
#ifdef AOV_COPY
  value = texelFetch(source, pixel, 0);
#endif
#ifdef AOV_DIRECT
  value = texelFetch(source, pixel, 0) + texelFetch(source2, pixel, 0);
#endif
#ifdef AOV_DEPTH
  value.x = FETCH(depth, pixel);
#endif
#ifdef AOV_POSITION
  float z = FETCH(depth, pixel);
  if (z > 0.0) value.xyz = (frame.world_from_view * vec4(view_position(vec2(pixel) + 0.5, z, frame.ray_scale, frame.ray_offset), 1.0)).xyz;
#endif
#ifdef AOV_BENT
  value.xyz = mat3(frame.world_from_view) * texelFetch(source, pixel, 0).xyz;
#endif
#ifdef AOV_NORMAL
  if (FETCH(depth, pixel) > 0.0) value.xyz = normalize(mat3(frame.world_from_view) * unpack_normal(FETCH(normal, pixel)));
#endif
#ifdef AOV_ALBEDO
  value.rgb = decode_albedo(texelFetch(albedo, pixel, 0).rgb);
#endif
#ifdef AOV_RADIANCE
  value.rgb = unpack_rgb9e5(FETCH(radiance, pixel));
#endif
#if defined(AOV_INDIRECT) || defined(AOV_AMBIENT)
  if (FETCH(depth, pixel) > 0.0) {
    vec4 material_texel = texelFetch(material, pixel, 0);
    Surface s = unpack_surface(texelFetch(albedo, pixel, 0), material_texel);
#ifdef AOV_INDIRECT
    value.rgb = diffuse_reflectance(s, material_texel.b) * texelFetch(source, pixel, 0).rgb;  // gi
#else
    vec3 to_eye = -normalize(view_ray(vec2(pixel) + 0.5, frame.ray_scale, frame.ray_offset));
    value.rgb = ambient_out(pixel, s, material_texel.b, material_texel.a, unpack_normal(FETCH(normal, pixel)), to_eye);
#endif
  }
#endif
}
