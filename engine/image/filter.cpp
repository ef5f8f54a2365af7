// Separable filters.
#include "image/filter.h"

#include <algorithm>

namespace nf::image {

Plane filtered(const Plane& plane, std::span<const float> across, std::span<const float> down) {
  const int width = int(plane.width), height = int(plane.height);
  const int reach_x = int(across.size() / 2), reach_y = int(down.size() / 2);
  Plane rows{plane.width, plane.height, std::vector<float>(plane.values.size())};
  std::vector<float> padded(size_t(width + 2 * reach_x));
  for (int y = 0; y < height; ++y) {
    const float* in = plane.values.data() + size_t(y) * plane.width;
    for (int x = 0; x < int(padded.size()); ++x) padded[size_t(x)] = in[std::clamp(x - reach_x, 0, width - 1)];
    float* out = rows.values.data() + size_t(y) * plane.width;
    for (size_t k = 0; k < across.size(); ++k)
      for (int x = 0; x < width; ++x) out[x] += across[k] * padded[size_t(x) + k];
  }
  Plane result{plane.width, plane.height, std::vector<float>(plane.values.size())};
  for (int y = 0; y < height; ++y) {
    float* out = result.values.data() + size_t(y) * plane.width;
    for (int k = -reach_y; k <= reach_y; ++k) {
      const float* in = rows.values.data() + size_t(std::clamp(y + k, 0, height - 1)) * plane.width;
      const float weight = down[size_t(k + reach_y)];
      for (int x = 0; x < width; ++x) out[x] += weight * in[x];
    }
  }
  return result;
}

}  // namespace nf::image
