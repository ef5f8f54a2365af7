// G-buffer: base colour, material, view-space normal, emission, velocity. MASKED cuts out by alpha.
#version 460
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/scene.glsl"
#include "common/surface.glsl"

layout(location = 0) in vec3 normal_in;
layout(location = 1) in vec4 tangent_in;
layout(location = 2) in vec2 uv0;
layout(location = 3) in vec4 color_in;
layout(location = 4) in vec3 clip;
layout(location = 5) in vec3 previous_clip;
layout(location = 6) flat in uint material_row;
#ifdef MAPPED
layout(location = 7) in vec2 uv1;
#endif

layout(scalar) readonly buffer material_table { Material rows[]; } materials;

layout(set = 1, binding = 0) uniform sampler2DArray base_color_map;
layout(set = 1, binding = 1) uniform sampler2DArray metallic_roughness_map;
layout(set = 1, binding = 2) uniform sampler2DArray normal_map;
layout(set = 1, binding = 3) uniform sampler2DArray emissive_map;
layout(set = 1, binding = 4) uniform sampler2DArray occlusion_map;

layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 material;
layout(location = 2) out uint normal;
layout(location = 3) out vec4 emissive;
layout(location = 4) out vec2 velocity;

// Where texture i of the material is looked up. Only MAPPED materials have transforms or a second set.
vec2 uv_of(Material m, int i) {
#ifdef MAPPED
  return m.uv_linear[i] * ((m.uv_sets >> i & 1u) != 0u ? uv1 : uv0) + m.uv_offset[i];
#else
  return uv0;
#endif
}

void main() {
  Material m = materials.rows[material_row];
  vec4 base = m.base_color * color_in;
  if (m.layers.x >= 0) base *= texture(base_color_map, vec3(uv_of(m, 0), m.layers.x));
#ifdef MASKED
  if (base.a < m.alpha_cutoff) discard;
#endif
  bool lambert = frame.lambert != 0u;

  vec3 n = normalize(normal_in);
  if (!gl_FrontFacing) n = -n;
  if (m.layers.z >= 0 && !lambert && dot(tangent_in.xyz, tangent_in.xyz) > 0.0) {
    vec3 t = normalize(tangent_in.xyz - n * dot(n, tangent_in.xyz));
    vec3 b = cross(n, t) * tangent_in.w;
    vec3 mapped = texture(normal_map, vec3(uv_of(m, 2), m.layers.z)).xyz * 2.0 - 1.0;
    n = normalize(t * (mapped.x * m.normal_scale) + b * (mapped.y * m.normal_scale) + n * mapped.z);
  }

  vec2 metallic_roughness = vec2(m.metallic, m.roughness);
  if (m.layers.y >= 0) metallic_roughness *= texture(metallic_roughness_map, vec3(uv_of(m, 1), m.layers.y)).bg;
  vec3 emission = m.emissive;
  if (m.layers.w >= 0) emission *= texture(emissive_map, vec3(uv_of(m, 3), m.layers.w)).rgb;

  float occlusion = 1.0;
  if (m.occlusion_layer >= 0)
    occlusion += m.occlusion_strength * (texture(occlusion_map, vec3(uv_of(m, 4), m.occlusion_layer)).r - 1.0);
  float f0 = m.dielectric_f0;
  if (m.unlit != 0u) {  // it shows its base colour, whatever falls on it
    emission = base.rgb;
    base.rgb = vec3(0.0);
    metallic_roughness.x = f0 = 0.0;
  }

  albedo = vec4(encode_albedo(base.rgb), 1.0);
  material = lambert ? vec4(0.0, 1.0, 0.0, 1.0) : vec4(metallic_roughness, f0, occlusion);
  normal = pack_normal(mat3(frame.view_from_world) * n);
  emissive = vec4(min(emission, 65504.0), 1.0);
  vec2 ndc = clip.xy / clip.z - previous_clip.xy / previous_clip.z;
  velocity = ndc * 0.5 * vec2(frame.size);
}
