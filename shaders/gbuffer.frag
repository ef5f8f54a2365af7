// G-buffer: base colour, material, view-space normal, emission, velocity. MASKED cuts out by alpha.
#version 460
#include "common/frame.glsl"
#include "common/material.glsl"
#include "common/pack.glsl"
#include "common/surface.glsl"

layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 material;
layout(location = 2) out uint normal;
layout(location = 3) out vec4 emissive;
layout(location = 4) out vec2 velocity;

void main() {
  Material m = materials.rows[material_row];
  vec4 base = base_color_of(m);
#ifdef MASKED
  if (base.a < m.alpha_cutoff) discard;
#endif
  MaterialPoint p = material_point(m, base.rgb);
  albedo = vec4(encode_albedo(p.base_color), 1.0);
  material = vec4(p.metallic, p.roughness, p.f0, p.occlusion);
  normal = pack_normal(mat3(frame.view_from_world) * p.normal);
  emissive = vec4(p.emission, 1.0);
  vec2 ndc = clip.xy / clip.z - previous_clip.xy / previous_clip.z;
  velocity = ndc * 0.5 * vec2(frame.size);
}
