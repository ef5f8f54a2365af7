// What arrives from a spot or point light, and how a highlight is widened. Compiles as GLSL and C++.
#ifndef NF_COMMON_LIGHTS_GLSL
#define NF_COMMON_LIGHTS_GLSL

// Share of the intensity after cone and range (KHR_lights_punctual): the cone is clamp(cos * scale + offset)^2, the window
// clamp(1 - (d / range)^4).
float light_falloff(float cosine, float cone_scale, float cone_offset, float distance2, float range) {
  float cone = clamp(cosine * cone_scale + cone_offset, 0.0f, 1.0f);
  float ratio = range > 0.0f ? distance2 / (range * range) : 0.0f;
  return cone * cone * clamp(1.0f - ratio * ratio, 0.0f, 1.0f);
}

// alpha of a GGX lobe, widened by the variance of the normals under the pixel: Tokuyoshi and Kaplanyan 2019, "Improved
// Geometric Specular Antialiasing", the isotropic form for deferred shading with the paper's sigma^2 = 1 / (2 pi) and
// kappa = 0.18: alpha'^2 = alpha^2 + min(2 sigma^2 (|dn/dx|^2 + |dn/dy|^2), kappa).
float widened_alpha(float alpha, vec3 dn_dx, vec3 dn_dy) {
  float kernel = min((dot(dn_dx, dn_dx) + dot(dn_dy, dn_dy)) * 0.318309886f, 0.18f);
  return sqrt(min(alpha * alpha + kernel, 1.0f));
}

#endif
