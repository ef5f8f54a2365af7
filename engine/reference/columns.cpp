// Depths and their slopes.
#include "reference/columns.h"

#include <cmath>

namespace nf::reference {
namespace {

// The smaller of two differences; one beside the edge of something is no slope.
double gentle(double back, double forward) {
  return std::abs(back) < std::abs(forward) ? back : forward;
}

}  // namespace

std::vector<Column> make_columns(const Buffers& b) {
  std::vector<Column> columns(b.depth.size());
  const auto w = [&](uint32_t x, uint32_t y) {
    const float z = b.depth[size_t(y) * b.size.x + x];
    return z > 0 ? 1 / double(z) : 0;
  };
  for (uint32_t y = 0; y < b.size.y; ++y) {
    for (uint32_t x = 0; x < b.size.x; ++x) {
      Column& c = columns[size_t(y) * b.size.x + x];
      c.w = w(x, y);
      const auto slope = [&](bool has_before, bool has_after, double before, double after) {
        const bool back = has_before && before > 0, forward = has_after && after > 0;
        if (back && forward) return gentle(c.w - before, after - c.w);
        return back ? c.w - before : forward ? after - c.w : 0;
      };
      if (c.w == 0) continue;
      c.slope.x = slope(x > 0, x + 1 < b.size.x, x > 0 ? w(x - 1, y) : 0, x + 1 < b.size.x ? w(x + 1, y) : 0);
      c.slope.y = slope(y > 0, y + 1 < b.size.y, y > 0 ? w(x, y - 1) : 0, y + 1 < b.size.y ? w(x, y + 1) : 0);
    }
  }
  return columns;
}

Screen::Screen(const scene::Camera& camera, glm::uvec2 size) {
  const double ty = std::tan(double(camera.vfov) / 2), tx = ty * size.x / size.y;
  scale = {2 * tx / size.x, -2 * ty / size.y};
  offset = {-tx, ty};
}

}  // namespace nf::reference
