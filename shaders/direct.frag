// Direct light of sun, point and spot lights: diffuse and specular apart, and the radiance that the GI gathers from
// (direct diffuse + emission of this frame).
#version 460
#include "common/fetch.glsl"
FETCH_FLOAT_IMAGE(depth);
#define FETCH_DEPTH(texel) FETCH(depth, texel)
#include "common/direct_light.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/surface.glsl"
#include "common/view.glsl"
#include "params/lights"

FETCH_UINT_IMAGE(normal);
uniform texture2D albedo;
uniform texture2D material;
uniform texture2D emissive;
layout(location = 0) out vec4 direct_diffuse;
layout(location = 1) out vec4 direct_specular;
layout(location = 2) out uint radiance;

vec3 position_at(ivec2 pixel, float z) { return view_position(vec2(pixel) + 0.5, z, frame.ray_scale, frame.ray_offset); }

// Of a pixel's two neighbours on an axis the one nearer to the plane of the normal, so that neither silhouettes nor creases
// count. `to` gets its position from here, view space.
ivec2 neighbour(ivec2 pixel, ivec2 axis, vec3 here, vec3 n, out vec3 to) {
  ivec2 before = max(pixel - axis, ivec2(0)), after = min(pixel + axis, frame.size - 1);
  float z0 = FETCH(depth, before), z1 = FETCH(depth, after);
  vec3 to0 = position_at(before, z0) - here, to1 = position_at(after, z1) - here;
  bool back = after == pixel || (before != pixel && abs(dot(n, to0)) < abs(dot(n, to1)));
  to = (back ? z0 : z1) > 0.0 ? (back ? to0 : to1) : vec3(0.0);
  return back ? before : after;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  direct_diffuse = direct_specular = vec4(0.0);
  radiance = 0u;
  float z = FETCH(depth, pixel);
  if (z <= 0.0) return;
  vec4 material_texel = texelFetch(material, pixel, 0);
  Surface s = unpack_surface(texelFetch(albedo, pixel, 0), material_texel);
  mat3 world_from_view = mat3(frame.world_from_view);
  vec3 here = position_at(pixel, z);
  vec3 normal_here = unpack_normal(FETCH(normal, pixel));
  vec3 to_x, to_y;
  ivec2 x = neighbour(pixel, ivec2(1, 0), here, normal_here, to_x), y = neighbour(pixel, ivec2(0, 1), here, normal_here, to_y);
  vec3 plane = cross(to_x, to_y) * float((x.x - pixel.x) * (pixel.y - y.y));
  plane *= inversesqrt(max(dot(plane, plane), 1e-30));
  if (dot(plane, normal_here) < 0.5) plane = normal_here;

  Receiver r;
  r.position = (frame.world_from_view * vec4(here, 1.0)).xyz;
  r.normal = world_from_view * normal_here;
  r.plane = world_from_view * plane;
  r.to_eye = normalize(frame.camera_position - r.position);
  r.alpha = max(s.roughness * s.roughness, 2e-3);
  if (lights.specular_aa != 0u)
    r.alpha = widened_alpha(r.alpha, unpack_normal(FETCH(normal, x)) - normal_here, unpack_normal(FETCH(normal, y)) - normal_here);
  r.f0 = s.f0;

  vec3 diffuse, specular;
  direct_light(r, pixel, z, diffuse, specular);
  diffuse *= diffuse_reflectance(s, material_texel.b) * (1.0 / 3.14159265358979);
  if (frame.lambert != 0u) specular = vec3(0.0);
  direct_diffuse = vec4(min(diffuse, 65504.0), 1.0);
  direct_specular = vec4(min(specular, 65504.0), 1.0);
  radiance = pack_rgb9e5(diffuse + texelFetch(emissive, pixel, 0).rgb);
}
