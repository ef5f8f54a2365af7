// What the same-information marchers, of the CPU and of the GPU, see of a depth buffer: a column a texel.
#pragma once

#include "reference/same_information.h"

namespace nf::reference {

// The front over the texel is 1 / depth = w + dot(slope, pixels from its centre).
struct Column {
  double w = 0;  // 0 = none
  glm::dvec2 slope{0};
};
std::vector<Column> make_columns(const Buffers& buffers);

// Pixels (integer + 0.5, y down) to tangents, as the renderer's frame block has them: pixel * scale + offset.
struct Screen {
  glm::dvec2 scale{1}, offset{0};
  Screen(const scene::Camera& camera, glm::uvec2 size);
  glm::dvec2 tangents(glm::dvec2 pixel) const { return pixel * scale + offset; }
};

}  // namespace nf::reference
