// One pixel's texels in every image of a frame.
#pragma once

#include "graph/probe.h"
#include "live/published.h"

namespace nf::editor::live {

inline constexpr const char* pixel_readback = "readback.texel";

// The texel that covers a pixel of a picture of this size, which lies `border` pixels inside what is rendered. Images
// with a whole share of those pixels are divided evenly; others in proportion.
glm::uvec2 covering_texel(glm::uvec2 pixel, glm::uvec2 picture, glm::ivec2 border, glm::uvec2 image);

// Reads one texel of each live image among the first `resources` rows, after its last pass; the values are still to
// come. Read-backs named `pixel_readback` have them, in this order but for those that are not of the view.
std::vector<ImageValue> read_pixel(graph::Graph& graph, size_t resources, glm::uvec2 pixel, glm::uvec2 picture,
                                   glm::ivec2 border);
// What a read-back holds, as it is stored and as it is meant.
void take_texel(const graph::Readback& readback, ImageValue& value);

}  // namespace nf::editor::live
