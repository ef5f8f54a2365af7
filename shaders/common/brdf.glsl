// Metallic-roughness specular by the glTF 2.0 specification, Appendix B: GGX distribution, height-correlated Smith
// visibility, Schlick Fresnel. alpha = roughness^2. Compiles as GLSL and C++.
#ifndef NF_COMMON_BRDF_GLSL
#define NF_COMMON_BRDF_GLSL

float ggx_distribution(float n_h, float alpha) {
  float a2 = alpha * alpha;
  float d = n_h * n_h * (a2 - 1.0f) + 1.0f;
  return a2 / (3.14159265358979f * d * d);
}

// G / (4 n.l n.v)
float smith_visibility(float n_l, float n_v, float alpha) {
  float a2 = alpha * alpha;
  float l = n_v * sqrt(n_l * n_l * (1.0f - a2) + a2);
  float v = n_l * sqrt(n_v * n_v * (1.0f - a2) + a2);
  return 0.5f / max(l + v, 1e-6f);
}

vec3 fresnel_schlick(vec3 f0, float v_h) {
  float x = clamp(1.0f - v_h, 0.0f, 1.0f);
  float x2 = x * x;
  return f0 + (1.0f - f0) * (x2 * x2 * x);
}

#endif
