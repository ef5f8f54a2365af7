// Mip chains of pictures on the CPU, so that they are the same on every device.
#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"

namespace nf::passes {

// Levels from the full size to 1x1, RGBA8, box-filtered; sRGB pictures are averaged in linear light.
using MipChain = std::vector<std::vector<uint8_t>>;
MipChain make_mips(const scene::Picture& picture);
// Of the pictures of these rows, on all cores.
std::vector<MipChain> make_mips(std::span<const scene::Picture> pictures, std::span<const uint32_t> rows);

}  // namespace nf::passes
