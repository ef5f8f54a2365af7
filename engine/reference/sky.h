// Directions chosen by how much light comes from them: for environment maps, whose light may come from few of them.
#pragma once

#include "reference/sampler.h"
#include "scene/environment.h"

namespace nf::reference {

class Sky {
 public:
  // Constant and gradient skies are even enough: any() is false.
  explicit Sky(const scene::Environment& environment);
  bool any() const { return !columns_.empty(); }

  struct Choice {
    glm::vec3 direction{0};
    float density = 0;  // per solid angle
  };
  Choice choose(glm::vec2 u) const;
  // With which choose() gives a direction.
  float density(glm::vec3 direction) const;

 private:
  uint32_t width_, height_;
  float rotation_;
  // Running sums of texels' brightness times solid angle: of rows, and along each row. Both end at 1.
  std::vector<float> rows_, columns_;
  float probability(uint32_t x, uint32_t y) const;
  float solid_angle(uint32_t y) const;
};

}  // namespace nf::reference
