// What gbuffer.vert hands over, and the material at that point of a surface. MAPPED: textures may have transforms or the second
// set of coordinates.
#ifndef NF_COMMON_MATERIAL_GLSL
#define NF_COMMON_MATERIAL_GLSL

#include "common/frame.glsl"
#include "common/scene.glsl"

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
layout(set = 1, binding = 5) uniform sampler2DArray specular_map;
layout(set = 1, binding = 6) uniform sampler2DArray specular_color_map;

struct MaterialPoint {
  vec3 base_color;
  vec3 emission;
  vec3 normal;  // world, on the seen side
  float metallic;
  float roughness;
  float f0;         // of the dielectric part
  float occlusion;  // the material's own, 1 = open
};

// Where texture i of the material is looked up.
vec2 uv_of(Material m, int i) {
#ifdef MAPPED
  return m.uv_linear[i] * ((m.uv_sets >> i & 1u) != 0u ? uv1 : uv0) + m.uv_offset[i];
#else
  return uv0;
#endif
}

#define texture_of(map, m, i) texture(map, vec3(uv_of(m, i), m.layers[i]), frame.texture_lod_bias)

// With alpha.
vec4 base_color_of(Material m) {
  vec4 base = m.base_color * color_in;
  if (m.layers[0] >= 0) base *= texture_of(base_color_map, m, 0);
  return base;
}

// KHR_materials_ior and KHR_materials_specular as one number: the strongest channel of the specular colour.
float dielectric_f0(Material m) {
  float specular = m.specular;
  if (m.layers[5] >= 0) specular *= texture_of(specular_map, m, 5).a;
  vec3 tint = m.specular_color;
  if (m.layers[6] >= 0) tint *= texture_of(specular_color_map, m, 6).rgb;
  return min(m.ior_f0 * max(tint.r, max(tint.g, tint.b)), 1.0) * specular;
}

MaterialPoint material_point(Material m, vec3 base_color) {
  MaterialPoint p;
  bool lambert = frame.lambert != 0u;
  p.base_color = min(base_color * frame.albedo_scale, vec3(1.0));
  p.normal = normalize(normal_in);
  if (!gl_FrontFacing) p.normal = -p.normal;
  if (m.layers[2] >= 0 && !lambert && dot(tangent_in.xyz, tangent_in.xyz) > 0.0) {
    vec3 t = normalize(tangent_in.xyz - p.normal * dot(p.normal, tangent_in.xyz));
    vec3 b = cross(p.normal, t) * tangent_in.w;
    vec3 mapped = texture_of(normal_map, m, 2).xyz * 2.0 - 1.0;
    p.normal = normalize(t * (mapped.x * m.normal_scale) + b * (mapped.y * m.normal_scale) + p.normal * mapped.z);
  }
  p.metallic = m.metallic;
  p.roughness = m.roughness;
  if (m.layers[1] >= 0) {
    vec4 texel = texture_of(metallic_roughness_map, m, 1);
    p.metallic *= texel.b;
    p.roughness *= texel.g;
  }
  p.emission = m.emissive;
  if (m.layers[3] >= 0) p.emission *= texture_of(emissive_map, m, 3).rgb;
  p.occlusion = 1.0;
  if (m.layers[4] >= 0) p.occlusion += m.occlusion_strength * (texture_of(occlusion_map, m, 4).r - 1.0);
  p.f0 = dielectric_f0(m);
  if (m.unlit != 0u) {  // it shows its base colour, whatever falls on it
    p.emission = base_color;
    p.base_color = vec3(0.0);
    p.metallic = p.f0 = 0.0;
  }
  if (lambert) {
    p.metallic = p.f0 = 0.0;
    p.roughness = p.occlusion = 1.0;
  }
  p.emission = min(p.emission * frame.emissive_scale, 65504.0);
  return p;
}

#endif
