// Where halos are: what is seen right beside something that stands in front of it.
#pragma once

#include <cstdint>
#include <vector>

namespace nf::image {

// A byte a pixel, 1 where within `reach` pixels to its left or right something is nearer by more than `gap` metres.
// `depth` in rows of `width`, metres, 0: none.
std::vector<uint8_t> ring_behind(const std::vector<float>& depth, uint32_t width, int reach, float gap);

}  // namespace nf::image
