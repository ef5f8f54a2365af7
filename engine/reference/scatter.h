// Directions about a normal, and the specular lobe of shaders/common/brdf.glsl with a way to sample it.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "reference/world.h"

namespace nf::reference {

// World from a frame whose z is `n`, a unit vector (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
inline mat3 frame_about(vec3 n) {
  const float sign = std::copysign(1.0f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return mat3(vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x), vec3(b, sign + n.y * n.y * a, -n.y), n);
}

// Equal areas of the square to equal areas of the unit disc (Shirley and Chiu 1997).
inline vec2 disc(vec2 u) {
  const vec2 p = 2.0f * u - 1.0f;
  if (p.x == 0 && p.y == 0) return vec2(0);
  const bool wide = std::abs(p.x) > std::abs(p.y);
  const float r = wide ? p.x : p.y;
  const float angle = wide ? pi / 4 * (p.y / p.x) : pi / 2 - pi / 4 * (p.x / p.y);
  return r * vec2(std::cos(angle), std::sin(angle));
}

// Density cos / pi about z.
inline vec3 cosine_direction(vec2 u) {
  const vec2 d = disc(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y))};
}

// GGX in the frame of the normal: v and l have z > 0. alpha = roughness^2, not below what the shader allows.
inline float alpha_of(float roughness) {
  return std::max(roughness * roughness, 2e-3f);
}
inline float ggx_distribution(float n_h, float alpha) {
  const float a2 = alpha * alpha, d = n_h * n_h * (a2 - 1) + 1;
  return a2 / (pi * d * d);
}
inline float smith_visibility(float n_l, float n_v, float alpha) {
  const float a2 = alpha * alpha;
  const float l = n_v * std::sqrt(n_l * n_l * (1 - a2) + a2), v = n_l * std::sqrt(n_v * n_v * (1 - a2) + a2);
  return 0.5f / std::max(l + v, 1e-6f);
}
inline vec3 fresnel_schlick(vec3 f0, float v_h) {
  const float x = std::clamp(1 - v_h, 0.0f, 1.0f), x2 = x * x;
  return f0 + (1.0f - f0) * (x2 * x2 * x);
}

// f * n.l
inline vec3 specular(vec3 f0, float alpha, vec3 v, vec3 l) {
  if (l.z <= 0) return vec3(0);
  const vec3 h = glm::normalize(v + l);
  return fresnel_schlick(f0, std::clamp(glm::dot(v, h), 0.0f, 1.0f)) *
         (l.z * ggx_distribution(std::clamp(h.z, 0.0f, 1.0f), alpha) * smith_visibility(l.z, v.z, alpha));
}
// Normals that v sees, and their density for the reflected direction (Heitz 2018).
inline vec3 specular_direction(float alpha, vec3 v, vec2 u) {
  const vec3 stretched = glm::normalize(vec3(alpha * v.x, alpha * v.y, v.z));
  const mat3 frame = frame_about(stretched);
  vec2 p = disc(u);
  // The disc's lower half, seen from `stretched`, is squeezed to the visible part of the hemisphere. Its axis of
  // squeezing must lie in the plane of the normal and v.
  vec3 across = vec3(-stretched.y, stretched.x, 0);
  const float length = glm::length(across);
  across = length > 1e-6f ? across / length : frame[0];
  const vec3 up = glm::cross(stretched, across);
  const float s = 0.5f * (1 + stretched.z);
  p.y = (1 - s) * std::sqrt(std::max(0.0f, 1 - p.x * p.x)) + s * p.y;
  const vec3 n = p.x * across + p.y * up + std::sqrt(std::max(0.0f, 1 - p.x * p.x - p.y * p.y)) * stretched;
  const vec3 h = glm::normalize(vec3(alpha * n.x, alpha * n.y, std::max(n.z, 1e-7f)));
  return 2 * glm::dot(v, h) * h - v;
}
inline float specular_density(float alpha, vec3 v, vec3 l) {
  if (l.z <= 0) return 0;
  const vec3 h = glm::normalize(v + l);
  const float a2 = alpha * alpha;
  const float g1 = 2 / (1 + std::sqrt(1 + a2 * (1 / (v.z * v.z) - 1)));
  return g1 * ggx_distribution(std::clamp(h.z, 0.0f, 1.0f), alpha) / (4 * v.z);
}

}  // namespace nf::reference
