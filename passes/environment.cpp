// The reflectance table.
#include "environment.h"

#include <cmath>

namespace nf::passes {

std::vector<glm::vec2> reflectance_table() {
  constexpr uint32_t side = reflectance_side, samples = 512;
  constexpr float pi = 3.14159265358979f;
  std::vector<glm::vec2> table;
  for (uint32_t row = 0; row < side; ++row)
    for (uint32_t column = 0; column < side; ++column) {
      const float n_v = (float(column) + 0.5f) / side, roughness = (float(row) + 0.5f) / side;
      const float a2 = roughness * roughness * roughness * roughness;
      const glm::vec3 v(std::sqrt(1 - n_v * n_v), 0, n_v);
      glm::vec2 sum(0);
      for (uint32_t i = 0; i < samples; ++i) {
        // Half vectors distributed as D(h) n.h, along a golden-ratio spiral.
        const float u = (float(i) + 0.5f) / samples, phi = 2 * pi * 0.618033988749895f * float(i);
        const float cosine = std::sqrt((1 - u) / (1 + (a2 - 1) * u)), sine = std::sqrt(1 - cosine * cosine);
        const glm::vec3 h(sine * std::cos(phi), sine * std::sin(phi), cosine);
        const float v_h = glm::dot(v, h);
        const float n_l = 2 * v_h * h.z - v.z;
        if (n_l <= 0 || v_h <= 0) continue;
        const float smith =
            0.5f / (n_v * std::sqrt(n_l * n_l * (1 - a2) + a2) + n_l * std::sqrt(n_v * n_v * (1 - a2) + a2));
        const float weight = 4 * smith * n_l * v_h / h.z;  // f n.l / pdf, without Fresnel
        const float fresnel = std::pow(1 - v_h, 5.0f);
        sum += weight * glm::vec2(1 - fresnel, fresnel);
      }
      table.push_back(sum / float(samples));
    }
  return table;
}

}  // namespace nf::passes
