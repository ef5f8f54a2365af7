// Separable filters over planes of floats, edges repeated: what SSIM and FLIP are made of.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace nf::image {

struct Plane {
  uint32_t width = 0, height = 0;
  std::vector<float> values;
};

// Correlates rows with `across` and columns with `down`, both of odd length and centred.
Plane filtered(const Plane& plane, std::span<const float> across, std::span<const float> down);

}  // namespace nf::image
