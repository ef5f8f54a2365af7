// Light straight from the environment, reflected: diffuse by irradiance and visibility, specular by the split sum (Karis
// 2013) with the table of passes/environment.cpp. Specular occlusion is the cosine-weighted visibility: an approximation.
// ENVIRONMENT_MAP: an environment that is not the same from all sides.
#ifndef NF_COMMON_AMBIENT_GLSL
#define NF_COMMON_AMBIENT_GLSL

#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
#endif

const int REFLECTANCE_SIDE = 16;
layout(scalar) readonly buffer reflectance_table { vec2 rows[]; } reflectance;

// Directional albedo of the specular lobe: F0 * x + y, bilinear over (n.v, roughness).
vec2 specular_albedo(float n_v, float roughness) {
  vec2 at = clamp(vec2(n_v, roughness) * float(REFLECTANCE_SIDE) - 0.5, 0.0, float(REFLECTANCE_SIDE - 1));
  ivec2 low = min(ivec2(at), REFLECTANCE_SIDE - 2);
  vec2 t = at - vec2(low);
  int row = low.y * REFLECTANCE_SIDE + low.x;
  return mix(mix(reflectance.rows[row], reflectance.rows[row + 1], t.x),
             mix(reflectance.rows[row + REFLECTANCE_SIDE], reflectance.rows[row + REFLECTANCE_SIDE + 1], t.x), t.y);
}

// normal, to_eye, bent: view space, unit; bent is the normal where the technique gives no better direction.
vec3 ambient_out(Surface s, float dielectric_f0, vec3 normal, vec3 to_eye, float visibility, vec3 bent) {
  float n_v = clamp(dot(normal, to_eye), 0.0, 1.0);
  vec3 reflected = diffuse_reflectance(s, dielectric_f0);
  vec3 mirrored = vec3(0.0);
  if (frame.lambert == 0u) {
    vec2 albedo = specular_albedo(n_v, s.roughness);
    mirrored = s.f0 * albedo.x + albedo.y;
  }
#ifdef ENVIRONMENT_MAP
  mat3 world_from_view = mat3(frame.world_from_view);
  reflected *= environment_irradiance(world_from_view * bent);
  if (frame.lambert == 0u) reflected += mirrored * environment_lobe(world_from_view * reflect(-to_eye, normal), s.roughness);
  return reflected * visibility;
#else
  return (reflected + mirrored) * frame.environment * visibility;
#endif
}

// The technique's mean unoccluded direction, or the normal where there is none.
vec3 bent_normal(vec3 bent, vec3 normal) { return dot(bent, bent) > 1e-6 ? normalize(bent) : normal; }

#endif
