// Light straight from a constant environment, reflected: diffuse by the visibility, specular by the split sum (Karis 2013)
// with the table of passes/environment.cpp. Specular occlusion is the cosine-weighted visibility: an approximation.
#ifndef NF_COMMON_AMBIENT_GLSL
#define NF_COMMON_AMBIENT_GLSL

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

vec3 ambient_out(Surface s, float dielectric_f0, float n_v, float visibility) {
  vec3 reflected = diffuse_reflectance(s, dielectric_f0);
  if (frame.lambert == 0u) {
    vec2 albedo = specular_albedo(n_v, s.roughness);
    reflected += s.f0 * albedo.x + albedo.y;
  }
  return reflected * frame.environment * visibility;
}

#endif
