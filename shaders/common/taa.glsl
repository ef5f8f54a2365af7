// Arithmetic of the temporal antialiasing. Compiles as GLSL and C++.
#ifndef NF_COMMON_TAA_GLSL
#define NF_COMMON_TAA_GLSL

#include "common/color.glsl"

// A compressed range in which one bright sample cannot outweigh its neighbours (Karis 2014), and back.
vec3 compress(vec3 c) { return c / (1.0f + luminance(c)); }
vec3 expand(vec3 c) { return c / max(1.0f - luminance(c), 1e-4f); }

// The point on the way from `mean` to `c` that lies within `reach` of the mean on every axis.
vec3 clip_to_box(vec3 c, vec3 mean, vec3 reach) {
  vec3 away = c - mean;
  vec3 units = abs(away) / max(reach, vec3(1e-6f));
  return mean + away / max(max(units.x, max(units.y, units.z)), 1.0f);
}

// Weights of the four texels around a point that lies f in [0, 1) beyond the second.
vec4 catmull_rom(float f) {
  return vec4(f * (-0.5f + f * (1.0f - 0.5f * f)), 1.0f + f * f * (-2.5f + 1.5f * f), f * (0.5f + f * (2.0f - 1.5f * f)),
              f * f * (-0.5f + 0.5f * f));
}

#endif
