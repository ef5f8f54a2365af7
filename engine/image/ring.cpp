// Rings of pixels.
#include "image/ring.h"

#include <cstddef>

namespace nf::image {

std::vector<uint8_t> ring_behind(const std::vector<float>& depth, uint32_t width, int reach, float gap) {
  std::vector<uint8_t> mask(depth.size(), 0);
  for (size_t i = 0; i < depth.size(); ++i) {
    const int x = int(i % width);
    for (int d = -reach; d <= reach && depth[i] > 0; ++d) {
      if (x + d < 0 || x + d >= int(width)) continue;
      const float other = depth[size_t(ptrdiff_t(i) + d)];
      if (other > 0 && other < depth[i] - gap) mask[i] = 1;
    }
  }
  return mask;
}

}  // namespace nf::image
