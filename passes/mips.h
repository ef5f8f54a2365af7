// Mip chains of pictures on the CPU, so that they are the same on every device.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace nf::passes {

// Levels from the full size to 1x1, RGBA8, box-filtered; sRGB pictures are averaged in linear light.
std::vector<std::vector<uint8_t>> make_mips(const scene::Picture& picture);

}  // namespace nf::passes
