// What the 32-bit words of the frame's images mean, for whoever shows a texel to people.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "graph/graph.h"

namespace nf::passes {

struct Unpacked {
  const char* meaning;
  std::vector<float> values;  // none: nothing is there
};
// Of an R32_UINT image of a frame, by its name in the graph; nothing for a name that is not known.
std::optional<Unpacked> unpack_texel(std::string_view image, graph::Size size, uint32_t bits);

// Whether the image covers the picture: shadow maps are seen from a light.
bool shows_view(std::string_view image);

}  // namespace nf::passes
