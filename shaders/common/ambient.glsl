// Light straight from the environment, reflected: diffuse by irradiance and visibility, specular by the split sum (Karis
// 2013) with the table of passes/environment.cpp. Specular occlusion is the cosine-weighted visibility: an approximation.
// ENVIRONMENT_MAP: an environment that is not the same from all sides. HAS_VISIBILITY, HAS_BENT, HAS_AMBIENT: what the
// technique gives of it.
#ifndef NF_COMMON_AMBIENT_GLSL
#define NF_COMMON_AMBIENT_GLSL

#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
#endif

#ifdef HAS_VISIBILITY
uniform texture2D visibility;
#endif
#ifdef HAS_BENT
uniform texture2D bent;
#endif
#ifdef HAS_AMBIENT
uniform texture2D ambient;  // irradiance / pi
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

// Mean unoccluded direction, or the normal where the technique finds none.
vec3 bent_normal(vec3 bent, vec3 normal) { return dot(bent, bent) > 1e-6 ? normalize(bent) : normal; }

// normal, to_eye: view space, unit. occlusion: the material's own.
vec3 ambient_out(ivec2 pixel, Surface s, float dielectric_f0, float occlusion, vec3 normal, vec3 to_eye) {
  float open = occlusion;
#ifdef HAS_VISIBILITY
  open *= texelFetch(visibility, pixel, 0).x;
#endif
  // A choice, not a condition: see bound.glsl.
  vec2 albedo = specular_albedo(clamp(dot(normal, to_eye), 0.0, 1.0), s.roughness);
  vec3 mirrored = (s.f0 * albedo.x + albedo.y) * (frame.lambert == 0u ? 1.0 : 0.0);
  vec3 irradiance = frame.environment;
#ifdef ENVIRONMENT_MAP
  mat3 world_from_view = mat3(frame.world_from_view);
  mirrored *= environment_lobe(world_from_view * reflect(-to_eye, normal), s.roughness);
#else
  mirrored *= frame.environment;
#endif
#ifdef HAS_AMBIENT
  irradiance = texelFetch(ambient, pixel, 0).rgb * occlusion;
#else
#ifdef ENVIRONMENT_MAP
#ifdef HAS_BENT
  irradiance = environment_irradiance(world_from_view * bent_normal(texelFetch(bent, pixel, 0).xyz, normal));
#else
  irradiance = environment_irradiance(world_from_view * normal);
#endif
#endif
  irradiance *= open;
#endif
  return diffuse_reflectance(s, dielectric_f0) * irradiance + mirrored * open;
}

#endif
