// Light from an environment that is not the same from all sides: passes/environment.h says what the block and the images
// hold. Directions are world space and unit.
#ifndef NF_COMMON_ENVIRONMENT_GLSL
#define NF_COMMON_ENVIRONMENT_GLSL
#include "params/environment"

uniform texture2D environment_map;
uniform textureCube environment_cube;
uniform sampler linear_repeat;
uniform sampler linear_clamp;

// The map itself. The sampler repeats in both directions; rows must not run over the poles.
vec3 environment_radiance(vec3 d) {
  float u = 0.5 + atan(d.z, d.x) * (0.5 / 3.14159265358979) + environment.map_turn;
  float v = 0.5 - asin(clamp(d.y, -1.0, 1.0)) * (1.0 / 3.14159265358979);
  float margin = 0.5 / float(textureSize(environment_map, 0).y);
  return textureLod(sampler2D(environment_map, linear_repeat), vec2(u, clamp(v, margin, 1.0 - margin)), 0.0).rgb;
}

// The bands of irradiance / pi's spherical harmonics, to be weighted and added.
struct Bands {
  vec3 constant;
  vec3 linear;
  vec3 quadratic;
};

Bands environment_bands(vec3 n) {
  Bands bands;
  bands.constant = environment.irradiance_0;
  bands.linear = environment.irradiance_1 * n.y + environment.irradiance_2 * n.z + environment.irradiance_3 * n.x;
  bands.quadratic = environment.irradiance_4 * (n.x * n.y) + environment.irradiance_5 * (n.y * n.z) +
                    environment.irradiance_6 * (3.0 * n.z * n.z - 1.0) + environment.irradiance_7 * (n.x * n.z) +
                    environment.irradiance_8 * (n.x * n.x - n.y * n.y);
  return bands;
}

// Irradiance / pi, from the second-order spherical harmonics (Ramamoorthi and Hanrahan 2001); a small sun's ringing goes
// below zero on the other side and is cut there.
vec3 environment_irradiance(vec3 n) {
  Bands bands = environment_bands(n);
  return max(bands.constant + bands.linear + bands.quadratic, 0.0);
}

// The radiance of the same order: the cosine lobe's factors 1, 2/3, 1/4 taken back.
vec3 environment_smooth_radiance(vec3 d) {
  Bands bands = environment_bands(d);
  return max(bands.constant + 1.5 * bands.linear + 4.0 * bands.quadratic, 0.0);
}

// Radiance averaged by the lobe: between the two mips next to the roughness (scene::prefilter_mip).
vec3 environment_lobe(vec3 reflected, float roughness) {
  float mip = environment.last_mip * roughness * (2.0 - roughness);
  float fine = floor(mip);
  vec3 a = textureLod(samplerCube(environment_cube, linear_clamp), reflected, fine).rgb;
  vec3 b = textureLod(samplerCube(environment_cube, linear_clamp), reflected, min(fine + 1.0, environment.last_mip)).rgb;
  return mix(a, b, mip - fine);
}

#endif
