// Blended surfaces over the finished frame: lit by sun, lamps and environment, without screen-space GI. Premultiplied alpha.
#version 460
#include "common/direct_light.glsl"
#include "common/frame.glsl"
#include "common/material.glsl"
#include "common/surface.glsl"
#include "common/view.glsl"
#include "common/ambient.glsl"
#include "params/lights"

layout(location = 0) out vec4 lit;

void main() {
  Material m = materials.rows[material_row];
  vec4 base = base_color_of(m);
  MaterialPoint p = material_point(m, base.rgb);
  Surface s;
  s.albedo = clamp(p.base_color, 0.0, 1.0);
  s.metallic = p.metallic;
  s.roughness = p.roughness;
  s.f0 = mix(vec3(p.f0), s.albedo, s.metallic);

  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = frame.near / gl_FragCoord.z;
  vec3 here = view_position(gl_FragCoord.xy, z, frame.ray_scale, frame.ray_offset);
  vec3 plane = cross(dFdx(here), dFdy(here));
  plane = dot(plane, here) > 0.0 ? -plane : plane;
  plane = mat3(frame.world_from_view) * plane * inversesqrt(max(dot(plane, plane), 1e-30));

  Receiver r;
  r.position = (frame.world_from_view * vec4(here, 1.0)).xyz;
  r.normal = p.normal;
  r.plane = dot(plane, p.normal) < 0.5 ? p.normal : plane;
  r.to_eye = normalize(frame.camera_position - r.position);
  r.alpha = max(s.roughness * s.roughness, 2e-3);
  vec3 dn_dx = dFdx(p.normal), dn_dy = dFdy(p.normal);
  if (lights.specular_aa != 0u) r.alpha = widened_alpha(r.alpha, dn_dx, dn_dy);
  r.f0 = s.f0;

  vec3 diffuse, specular;
  direct_light(r, pixel, z, diffuse, specular);
  diffuse *= diffuse_reflectance(s, p.f0) * (1.0 / 3.14159265358979);
  if (frame.lambert != 0u) specular = vec3(0.0);
  mat3 view_from_world = mat3(frame.view_from_world);
  vec3 ambient = ambient_out(pixel, s, p.f0, p.occlusion, view_from_world * p.normal, view_from_world * r.to_eye);
  float alpha = clamp(base.a, 0.0, 1.0);
  lit = vec4(min(diffuse + specular + ambient + p.emission, 65504.0) * alpha, alpha);
}
